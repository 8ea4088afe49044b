"""A solver for one question compiles the search for routes where it is needed, and does not call that solving."""

import time
from typing import Any

import pytest

import sinuous as sn
from sinuous.solver.routing.searches import Searches

THREE = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05)
SCENE = [sn.Sphere((0.5, 0.0, 1.5), 0.2)]
NEAR, FAR = sn.Target((1.0, 0.0, 2.0)), sn.Target((0.0, 0.0, 9.0))
TORN = [sn.Target((1.0, 0.0, 2.0)), sn.Target((-1.0, 0.0, 2.0))]
"""Cannot be met, which nothing proves."""


LOADING = 1000.0
"""Seconds, by a clock that is put forward."""


@pytest.fixture
def loads(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """What is appended to whenever the search for routes is loaded, which takes `LOADING` each time."""
    seen: list[float] = []

    def load(self: Searches, *, anew: bool = False) -> None:
        seen.append(LOADING)

    monkeypatch.setattr("sinuous.base.progress.perf_counter", lambda: time.perf_counter() + sum(seen))
    monkeypatch.setattr(Searches, "load", load)
    return seen


@pytest.mark.parametrize(("target", "count"), [(NEAR, 0), (FAR, 0), (TORN, 1)], ids=["solved", "proved", "open"])
def test_it_is_loaded_where_the_first_starts_decide_nothing(loads: list[float], target: Any, count: int) -> None:
    solution = sn.Solver._for_one_query(THREE, SCENE, time=60.0, max_starts=20).solve(target)
    assert solution.solved is (target is NEAR)
    assert bool(loads) is bool(count)
    assert solution.seconds < LOADING  # it is no part of the budget


def test_a_solver_for_many_has_it_ahead(loads: list[float]) -> None:
    solver = sn.Solver(THREE, SCENE)
    assert len(loads) == 1
    assert solver.solve(NEAR).solved
    assert len(loads) == 1
