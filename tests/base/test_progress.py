"""The bar shows itself to a person who waits, and to nobody else."""

import io
import sys
import time

import pytest

from sinuous.base.progress import LONG, ProgressBar


class Terminal(io.StringIO):
    """A standard error that somebody looks at."""

    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(("total", "terminal", "shows"), [(LONG, True, True), (1, True, False), (LONG, False, False)])
def test_it_shows_when_it_should(monkeypatch: pytest.MonkeyPatch, *, total: int, terminal: bool, shows: bool) -> None:
    stream = Terminal() if terminal else io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with ProgressBar(total) as bar:
        bar.advance()
        with bar.hidden():
            pass
    assert (stream.getvalue() != "") is shows
    assert ("1 of 10" in stream.getvalue()) is shows


@pytest.mark.parametrize(("terminal", "late", "shows"), [(True, 0.01, True), (True, 60.0, False), (False, 0.01, False)])
def test_what_is_not_counted_is_shown_when_it_takes_long(
    monkeypatch: pytest.MonkeyPatch, *, terminal: bool, late: float, shows: bool
) -> None:
    stream = Terminal() if terminal else io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with ProgressBar(late=late) as bar:
        bar.say("reading engine.yaml")
        if shows:
            until = time.monotonic() + 60.0
            while "engine.yaml" not in stream.getvalue() and time.monotonic() < until:
                time.sleep(0.01)
        bar.say("preparing housing", 0.5)
    assert ("reading engine.yaml" in stream.getvalue()) is shows
    assert ("housing" in stream.getvalue()) is shows
