"""The queue of attempts: the one with the lowest priority first, scattered starts in proportion, each attempt switched
off by its name."""

from collections.abc import Iterator
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sinuous as sn
from sinuous import Robot, Scene, Sphere, Target, Tolerance
from sinuous.kernels.tables import ROUTE, SOURCES
from sinuous.problem.problem import Problem
from sinuous.solver import strategy as own
from sinuous.solver.attempts import (
    EFFORT_OF_A_CHAIN,
    IKQuery,
    RandomRestarts,
    StartBatch,
)
from sinuous.solver.options import ATTEMPTS
from sinuous.solver.routing.searches import Searches
from sinuous.solver.strategy import attempts_of

ROBOT = Robot.uniform(5, length=(0.8, 1.2), max_bend=2.4, radius=0.1)
SCENE = Scene([Sphere((0, 0, 2.2), 0.7), Sphere((0.9, 0.2, 3.1), 0.4)])
TARGET = Target((0, 0, 4.4))


def question(scene: Scene = SCENE, seconds: float = 60.0, several: bool = False, given: int = 0) -> IKQuery:
    return IKQuery(Problem(ROBOT, TARGET, scene), np.zeros((given, 5, 3)), lambda: seconds, several)


@pytest.fixture(autouse=True)
def few_passages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Close passages and lead routes aside a few times and no more: each searches, or grows chains."""
    monkeypatch.setattr(own, "PASSAGES_SEARCHES", 6)
    monkeypatch.setattr(own, "DETOURS", 4)


def chains(count: int, effort: float = 0.0) -> Iterator[StartBatch]:
    yield StartBatch(SOURCES[ROUTE], np.zeros((count, 5, 3)), effort=effort)


@given(st.lists(st.tuples(st.integers(0, 20), st.floats(0, 30), st.integers(0, 3)), max_size=10))
def test_scattered_starts_are_in_proportion_to_what_others_cost(asked: list[tuple[int, float, int]]) -> None:
    without = set(ATTEMPTS) - {"grown", "scattered"}
    searches = Searches(ROBOT, SCENE, Tolerance().for_robot(ROBOT))
    strategy = attempts_of(question(), RandomRestarts(3, 5000), searches, without=without)
    for priority, more, size in asked:
        strategy.add("grown", priority, partial(chains, size, more))
    batches = list(strategy.batches())
    effort = sum(priority + more + EFFORT_OF_A_CHAIN * size for priority, more, size in asked)
    assert strategy.effort_spent["grown"] == pytest.approx(effort)
    scattered = strategy.effort_spent["scattered"]
    share = own.SHARE_AMONG_BALLS * effort
    assert share - 1 < max(share, scattered) <= max(share, own.SCATTERED_FIRST) + 1
    assert share - 1 < scattered
    numbers = [i for batch in batches for i in range(*batch.own)]
    assert numbers == list(range(3, 5000))


@pytest.mark.parametrize("name", ATTEMPTS)
def test_a_solve_takes_what_is_switched_off(name: str) -> None:
    solution = sn.solve(ROBOT, TARGET, SCENE, without=name, time=20.0)
    assert solution.solved
    assert solution._resolver.solve(solution.problem).solved
