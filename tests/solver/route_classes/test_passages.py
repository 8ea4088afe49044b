"""Routes through different passages: which ones, in what order, and what is tried again."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import pytest

from sinuous.problem.problem import Problem
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver import strategy
from sinuous.solver.attempts import ATTEMPTS, IKQuery, RandomRestarts, StartBatch
from sinuous.solver.route_classes.curves import RouteCurves
from sinuous.solver.route_classes.passages import Passages
from sinuous.solver.routing.searches import Searches, SearchPlan
from sinuous.solver.strategy import attempts_of
from tests.helpers import Floats
from tests.solver.route_classes.places import BARS, DOORS, ROBOT, TARGET, bars, pillar, wall


def explored(
    obstacles: list[Obstacle], solved: Callable[[Floats], bool], target: Target = TARGET, seconds: float = 60.0
) -> list[StartBatch]:
    scene, tolerance = Scene(obstacles), Tolerance().for_robot(ROBOT)
    problem = Problem(ROBOT, target, scene, tolerance)
    question = IKQuery(problem, np.empty((0, len(ROBOT), 3)), lambda: seconds, several=True)
    searches, curves = Searches(ROBOT, scene, tolerance), RouteCurves(ROBOT, scene.snapshot())
    make = partial(Passages, searches, curves, solved=solved)
    without = set(ATTEMPTS) - {"passages"}
    return list(attempts_of(question, RandomRestarts(3, 3), searches, without=without, passages=make).batches())


def crossed(batches: list[StartBatch], z: float) -> list[float]:
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
    monkeypatch.setattr(strategy, "PASSAGES_SEARCHES", 6)
    left, right = sorted(crossed(explored(pillar(), lambda curve: True), 150.0))  # one start of each class
    assert left < 0.0 < right
    every = crossed(explored(pillar(), lambda curve: False), 150.0)
    assert len(every) > 2


def test_without_time_or_position_nothing_is_searched_for() -> None:
    assert explored(pillar(), once(), seconds=0.0) == []
    assert explored(pillar(), once(), target=Target(direction=(0, 0, 1))) == []


def test_a_scene_is_not_copied_where_time_does_not_suffice(monkeypatch: pytest.MonkeyPatch) -> None:
    def copied(scene: Snapshot, screens: Sequence[Mesh]) -> Snapshot:
        assert not screens
        return scene

    monkeypatch.setattr(Snapshot, "beside", copied)
    with pytest.raises(AssertionError):
        explored(pillar(), once())
    monkeypatch.setattr(RouteCurves, "seconds", lambda _: 1e-8)
    assert len(crossed(explored(pillar(), once()), 150.0)) == 1


def test_what_is_probably_closed_comes_last_and_with_finer_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no search finds a route, each of them is made once, from the quickest on."""
    plans: list[SearchPlan] = []

    def nothing(self: Passages, closed: frozenset[int], plan: SearchPlan) -> tuple[list[Floats], int]:
        plans.append(plan)
        return [], 10

    monkeypatch.setattr(Passages, "routes", nothing)
    explored(pillar(), once())
    single = Searches(ROBOT, Scene(pillar()), Tolerance().for_robot(ROBOT)).single_plans
    assert plans == list(single)


def test_passages_of_new_routes_come_before_finer_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[int, float]] = []
    routes = Passages.routes

    def noted(self: Passages, closed: frozenset[int], plan: SearchPlan) -> tuple[list[Floats], int]:
        asked.append((len(closed), plan.cell))
        return routes(self, closed, plan)

    monkeypatch.setattr(Passages, "routes", noted)
    explored(bars(), once())
    first = asked[0][1]
    assert [cell for closed, cell in asked if closed <= 1][:2] == [first, first]
    later = [cell for _, cell in asked]
    assert later.index(min(later)) > sum(cell == first for cell in later) // 2


def test_one_solution_is_looked_for_along_one_route_of_each_class() -> None:
    scene, tolerance = Scene(pillar()), Tolerance().for_robot(ROBOT)
    question = IKQuery(Problem(ROBOT, TARGET, scene, tolerance), np.empty((0, len(ROBOT), 3)), lambda: 60.0)
    without = set(ATTEMPTS) - {"passages", "laid"}
    attempts = attempts_of(question, RandomRestarts(3, 3), Searches(ROBOT, scene, tolerance), without=without)
    left, right = sorted(crossed(list(attempts.batches()), 150.0))
    assert left < 0.0 < right
