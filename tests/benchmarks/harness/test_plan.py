"""Sizes, random numbers and progress of a run."""

import contextlib
import io
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from benchmarks.harness import plan as module
from benchmarks.harness.plan import Plan


def test_quick_runs_are_small() -> None:
    assert (Plan().count(100, 2), Plan(quick=True).count(100, 2)) == (100, 2)


def test_random_numbers_are_those_of_seed_and_stream() -> None:
    first, again = Plan(3).rng(1, 2), Plan(3).rng(1, 2)
    np.testing.assert_array_equal(first.random(5), again.random(5))
    drawn = [plan.rng(*stream).random() for plan in (Plan(3), Plan(4)) for stream in ((1,), (2,), (1, 2))]
    assert len(set(drawn)) == 6


def test_bars_may_be_within_bars(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = io.StringIO()

    def terminal(**_: Any) -> Console:
        return Console(file=screen, force_terminal=True, width=80)

    monkeypatch.setattr(module, "Console", terminal)
    monkeypatch.setattr(module, "REFRESH", 0.0)
    plan = Plan()
    for _ in range(2):
        seen = [(i, j) for i in plan.track("ab", "outer", 2) for j in plan.track(range(3), "inner", 3)]
        assert seen == [(i, j) for i in "ab" for j in range(3)]
    assert "outer" in screen.getvalue()
    assert "inner" in screen.getvalue()
    with contextlib.suppress(ZeroDivisionError):
        for _ in plan.track("ab", "outer", 2):
            raise ZeroDivisionError
    assert list(plan.track("ab", "after", 2)) == ["a", "b"]
