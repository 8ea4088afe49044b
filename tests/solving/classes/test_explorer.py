"""Routes through different passages: which ones, in what order, and what is tried again."""

from collections.abc import Callable

import numpy as np
import pytest

from sinuous.problem.problem import Problem
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene
from sinuous.solving.classes import explorer
from sinuous.solving.classes.curves import Curves
from sinuous.solving.classes.explorer import Explorer
from sinuous.solving.classes.tasks import Task, Tasks
from sinuous.solving.routing.searches import Searches
from sinuous.solving.starts import Batch, Question
from tests.helpers import Floats
from tests.solving.classes.places import BARS, DOORS, ROBOT, TARGET, bars, pillar, wall


def explored(
    obstacles: list[Obstacle], solved: Callable[[Floats], bool], target: Target = TARGET, seconds: float = 60.0
) -> list[Batch]:
    scene, tolerance = Scene(obstacles), Tolerance().for_robot(ROBOT)
    problem = Problem(ROBOT, target, scene, tolerance)
    question = Question(problem, np.empty((0, len(ROBOT), 3)), lambda: seconds)
    source = Explorer(Searches(ROBOT, scene, tolerance), Curves(ROBOT, scene.snapshot()), solved)
    return list(source.batches(question))


def crossed(batches: list[Batch], z: float) -> list[float]:
    """Where along x the routes of starts cross a height."""
    routes = [route for batch in batches for route in batch.routes]
    return [float(np.interp(z, route[:, 2], route[:, 0])) for route in routes]


def once() -> Callable[[Floats], bool]:
    """Say that a class is solved as soon as it was asked about."""
    seen: list[Floats] = []

    def solved(curve: Floats) -> bool:
        known = any(curve is other for other in seen)
        seen.append(curve)
        return known

    return solved


@pytest.mark.parametrize(
    ("place", "z", "edges"),
    [(pillar, 150.0, (0.0,)), (bars, 140.0, BARS), (wall, 150.0, (*DOORS[0], *DOORS[1]))],
    ids=["pillar", "bars", "wall"],
)
def test_there_is_a_route_through_every_passage(
    place: Callable[[], list[Obstacle]], z: float, edges: tuple[float, ...]
) -> None:
    batches = explored(place(), once())
    gaps = [int(np.searchsorted(edges, x)) for x in crossed(batches, z)]
    expected = {1, 3} if place is wall else set(range(len(edges) + 1))
    assert set(gaps) == expected
    assert {batch.source for batch in batches} == {"route"}
    assert sum(batch.cost for batch in batches) > 0


def test_where_no_start_is_solved_others_follow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(explorer, "SEARCHES", 6)
    left, right = sorted(crossed(explored(pillar(), lambda curve: True), 150.0))  # one start of each class
    assert left < 0.0 < right
    every = crossed(explored(pillar(), lambda curve: False), 150.0)
    assert len(every) > 2


def test_without_time_or_position_nothing_is_searched_for() -> None:
    assert explored(pillar(), once(), seconds=0.0) == []
    assert explored(pillar(), once(), target=Target(direction=(0, 0, 1))) == []


def test_what_is_probably_closed_comes_last_and_by_plans() -> None:
    tasks = Tasks(3)
    tasks.add(Task(frozenset({1}), 2), last=True)
    tasks.add(Task(frozenset({2}), 1), last=True)
    tasks.add(Task(frozenset({3}), 0))
    tasks.add(Task(frozenset({4}), 3))  # there is no such plan
    tasks.add(Task(frozenset({5}), 2))
    order = [task.closed for task in iter(tasks.next, None)]
    assert order == [{3}, {5}, {2}, {1}]
