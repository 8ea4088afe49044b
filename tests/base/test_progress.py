"""The bar shows itself to a person who waits, and to nobody else."""

import io
import sys

import pytest

from sinuous.base.progress import LONG, ProgressBar
from tests.cli.test_progress import Terminal


@pytest.mark.parametrize(("total", "terminal", "shows"), [(LONG, True, True), (1, True, False), (LONG, False, False)])
def test_it_shows_when_it_should(monkeypatch: pytest.MonkeyPatch, *, total: int, terminal: bool, shows: bool) -> None:
    stream = Terminal() if terminal else io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with ProgressBar(total) as bar:
        bar.advance()
        with bar.hidden():
            pass
    assert (stream.getvalue() != "") is shows
