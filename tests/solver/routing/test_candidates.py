"""The routes of one question: which are alike, larger tables, and legs."""

from itertools import combinations

import numpy as np
import pytest

from sinuous import Robot, Scene, Sphere, Target, Tolerance
from sinuous.base.checks import Floats
from sinuous.kernels.tables import FOUND, FULL
from sinuous.model.poses import pose
from sinuous.problem.problem import Problem
from sinuous.solver.attempts import ATTEMPTS, IKQuery, RandomRestarts
from sinuous.solver.routing.candidates import ALIKE, RouteCandidates
from sinuous.solver.routing.searches import CELLS, FoundRoutes, Searches, SearchPlan
from sinuous.solver.strategy import attempts_of

ROBOT = Robot.uniform(5, length=(0.8, 1.2), max_bend=2.4, radius=0.1)
SCENE = Scene([Sphere((0, 0, 2.2), 0.7), Sphere((0.9, 0.2, 3.1), 0.4)])
IN_WALL = np.array([0.0, 0.0, 2.2])
TIP, ELBOW = Target((0, 0, 4.4)), Target((0.4, 0.0, 2.0), segment=2)


def asked(robot: Robot = ROBOT, targets: tuple[Target, ...] = (TIP,)) -> tuple[Searches, IKQuery, RouteCandidates]:
    searches = Searches(robot, SCENE, Tolerance().for_robot(robot))
    question = IKQuery(Problem(robot, list(targets), SCENE), np.empty((0, len(robot), 3)), lambda: 60.0)
    query = searches.query(question.problem)
    assert query is not None
    return searches, question, RouteCandidates(searches, question, query)


def only_cells(searches: Searches, question: IKQuery) -> None:
    """Search over cells, and try nothing along what is found."""
    list(attempts_of(question, RandomRestarts(3, 10), searches, without=set(ATTEMPTS) - {"cells"}).batches())


def test_routes_that_are_alike_are_one_candidate() -> None:
    _, _, candidates = asked()
    line = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.4), 30)
    near = line + np.array([0.9 * ALIKE * 0.1, 0.0, 0.0])
    far = line + np.array([1.1 * ALIKE * 0.1, 0.0, 0.0])
    for route, count in ((line, 1), (near, 1), (far, 2), (line[:, [1, 2, 0]], 3)):
        candidates.add_route(route, True)
        assert len(candidates.known) == count


def test_a_table_that_is_too_small_is_made_larger_before_anything_else(monkeypatch: pytest.MonkeyPatch) -> None:
    searches, question, _ = asked()
    plans: list[SearchPlan] = []

    def full(self: Searches, problem: Problem, query: Floats, plan: SearchPlan, seconds: float) -> FoundRoutes:
        plans.append(plan)
        return FoundRoutes([], FULL, 10)

    monkeypatch.setattr(Searches, "find", full)
    monkeypatch.setattr(Searches, "by_edges", lambda *_: None)
    only_cells(searches, question)
    fine = [plan.cells for plan in plans if plan.cell == searches.fine.cell]
    coarse, middle = ([plan.cells for plan in plans if plan.cell == each.cell] for each in searches.leg_plans[:2])
    assert fine == list(CELLS)
    assert coarse == middle == list(CELLS[:-1])
    assert [plan.cells for plan in plans[:2]] == list(CELLS[:-1])


def test_a_leg_is_looked_for_around_edges_before_over_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    asked_for: list[str] = []
    searches, _, candidates = asked(targets=(ELBOW, TIP))

    def around(query: Floats) -> Floats | None:
        asked_for.append("edges")
        return np.linspace((0.0, 0.0, 0.0), (0.4, 0.0, 2.0), 20) if len(asked_for) == 1 else None

    def found(problem: Problem, query: Floats, plan: SearchPlan, seconds: float) -> FoundRoutes:
        asked_for.append("cells")
        return FoundRoutes([], FULL, plan.cells)

    monkeypatch.setattr(candidates, "route_around_edges", around)
    monkeypatch.setattr(candidates, "route_through_side_tubes", lambda query: None)
    monkeypatch.setattr(searches, "find", found)
    assert candidates._found_legs is None
    assert asked_for[:3] == ["edges", "edges", "cells"]
    assert set(asked_for[2:]) == {"cells"}


@pytest.mark.parametrize("wall", [False, True])
def test_a_leg_that_cuts_through_a_wall_is_looked_for_over_smaller_cells(
    wall: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where it does so near one of its ends."""
    searches, _, candidates = asked(targets=(ELBOW, TIP))
    line = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 60)
    if wall:
        line[1] = IN_WALL
    plans: list[SearchPlan] = []

    def found(problem: Problem, query: Floats, plan: SearchPlan, seconds: float) -> FoundRoutes:
        plans.append(plan)
        return FoundRoutes([line], FOUND, plan.cells)

    monkeypatch.setattr(candidates, "route_around_edges", lambda query: None)
    monkeypatch.setattr(candidates, "route_through_side_tubes", lambda query: None)
    monkeypatch.setattr(searches, "find", found)
    assert candidates._leg(candidates.query) is line
    assert plans == list(searches.leg_plans[: None if wall else 1])


@pytest.mark.parametrize("clear", [True, False])
def test_middle_cells_are_looked_at_where_no_clear_route_is_known(clear: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    searches, question, _ = asked()
    line = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 60)
    plans: list[SearchPlan] = []

    def found(self: Searches, problem: Problem, query: Floats, plan: SearchPlan, seconds: float) -> FoundRoutes:
        plans.append(plan)
        return FoundRoutes([line if clear else line + IN_WALL], FOUND, plan.cells)

    monkeypatch.setattr(Searches, "find", found)
    monkeypatch.setattr(Searches, "by_edges", lambda *_: None)
    only_cells(searches, question)
    assert searches.coarse.cell > searches.middle.cell > searches.fine.cell
    assert (searches.middle in plans) == (not clear)


def test_with_a_tool_routes_also_lead_to_where_the_backbone_may_end() -> None:
    reach = 0.3
    _, _, candidates = asked(ROBOT.changed(tool=pose((0.0, 0.0, reach))))
    assert candidates.has_tool
    assert not asked()[2].has_tool
    candidates.add_route(np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.4), 30), True)
    routes = [candidates.route_to_terminal_pose(number) for number in range(3)]
    ends = np.array([route[-1] for route in routes if route is not None])
    assert len(ends) == 3
    np.testing.assert_allclose(np.linalg.norm(ends - TIP.position, axis=1), reach)
    assert min(np.linalg.norm(a - b) for a, b in combinations(ends, 2)) > 0.1 * reach
    assert candidates.route_to_terminal_pose(1000) is None


def test_what_is_nearer_to_the_target_than_the_tool_may_lie_beyond_a_wall() -> None:
    reach, route = 0.8, np.linspace((2.0, 0.0, 2.2), IN_WALL, 60)
    for robot, clear in ((ROBOT.changed(tool=pose((0.0, 0.0, reach))), True), (ROBOT, False)):
        _, _, candidates = asked(robot, (Target(IN_WALL),))
        assert candidates._clear(route, candidates.query) == clear
