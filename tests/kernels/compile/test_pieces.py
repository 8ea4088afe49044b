"""What is compiled is said before it begins, once, with what and how long."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sinuous.kernels import compile as compiling
from sinuous.kernels.compile import store, tiers


@pytest.fixture
def fresh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[int], Any]:
    """Make an entry, with a cache of its own, that belongs to a piece of so many seconds."""
    monkeypatch.setattr(store, "CACHE", tmp_path)
    monkeypatch.setattr(tiers, "_announced", [])

    def make(seconds: int) -> Any:
        name = f"{half.__module__.partition('.')[2]}.{half.__name__}"
        monkeypatch.setattr(tiers, "PIECES", (tiers.Piece("halves", seconds, (name,)),))
        return compiling.entry(half)

    return make


def half(x: float) -> float:
    return 0.5 * x


def test_compiling_is_announced_with_what_and_how_long_and_loading_is_not(
    fresh: Callable[[int], Any], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fresh(9)(2.0) == 1.0
    said = "sinuous: compiling halves, once on this machine (about 9 s); 'sinuous warm' compiles everything ahead\n"
    assert capsys.readouterr().err == said
    monkeypatch.setattr(tiers, "_announced", [])
    again = fresh(9)
    assert again(4.0) == 2.0
    assert sum(again.stats.cache_hits.values()) == 1
    assert capsys.readouterr().err == ""


def test_compiling_a_piece_is_announced_once_in_a_process(
    fresh: Callable[[int], Any], capsys: pytest.CaptureFixture[str]
) -> None:
    entry = fresh(9)
    entry(2.0)
    entry(2)
    assert capsys.readouterr().err.count("compiling") == 1
    assert len(entry.signatures) == 2
