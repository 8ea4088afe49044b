"""What takes long shows itself to a person who waits, and to nobody else."""

import io
import sys
import time

import pytest

from sinuous.cli import reading
from sinuous.cli.reading import waiting


class Terminal(io.StringIO):
    """A standard error that somebody looks at."""

    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("terminal", "patience", "shows"), [(True, 0.0, True), (True, 60.0, False), (False, 0.0, False)]
)
def test_reading_is_shown_when_it_takes_long(
    monkeypatch: pytest.MonkeyPatch, *, terminal: bool, patience: float, shows: bool
) -> None:
    stream = Terminal() if terminal else io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr(reading, "PATIENCE", patience)
    with waiting() as show:
        show("reading engine.yaml", None)
        if shows:
            until = time.monotonic() + 60.0
            while "engine.yaml" not in stream.getvalue() and time.monotonic() < until:
                time.sleep(0.01)
        show("preparing housing", 0.5)
    assert ("reading engine.yaml" in stream.getvalue()) is shows
    assert ("housing" in stream.getvalue()) is shows
