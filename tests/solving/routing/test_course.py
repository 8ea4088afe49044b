"""The order of what is tried along routes: cheap before dear, and nothing twice."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from sinuous import Box, Capsule, Robot, Scene, Sphere, Target, Tolerance
from sinuous.checks import Floats
from sinuous.kernels.tables import FOUND, FULL, QUERY_AXIS
from sinuous.problem.problem import Problem
from sinuous.scene.obstacles import Obstacle
from sinuous.solving.routing.course import ALIKE, AMONG_BALLS, SHARE, STOWED, Course
from sinuous.solving.routing.crossing import STARTS
from sinuous.solving.routing.growth import FEW, GLANCE, MANY, ONE, Beam, grown
from sinuous.solving.routing.plans import CELLS, GATES, GROWN, Plan, chores_of
from sinuous.solving.routing.routes import Router
from sinuous.solving.routing.searches import Found
from sinuous.solving.starts.sources import Batch, Question

ROBOT = Robot.uniform(5, length=(0.8, 1.2), max_bend=2.4, radius=0.1)
SCENE = Scene([Sphere((0, 0, 2.2), 0.7), Sphere((0.9, 0.2, 3.1), 0.4)])
TARGET = Target((0, 0, 4.4))


def asked(several: bool = False, robot: Robot = ROBOT) -> tuple[Router, Question, Floats]:
    router = Router(robot, SCENE, Tolerance().for_robot(robot))
    question = Question(Problem(robot, TARGET, SCENE), np.empty((0, len(robot), 3)), lambda: 60.0, several)
    query = router.query(question.problem)
    assert query is not None
    return router, question, query


def recorded(monkeypatch: pytest.MonkeyPatch) -> list[tuple[bytes, Beam]]:
    """What chains are grown along, and how, from now on."""
    calls: list[tuple[bytes, Beam]] = []

    def spy(groups: Any, legs: Floats, beam: Beam, seconds: float) -> Floats:
        calls.append((groups[3].tobytes() + legs.tobytes(), beam))
        return grown(groups, legs, beam, seconds)

    monkeypatch.setattr("sinuous.solving.routing.course.grown", spy)
    return calls


def test_nothing_is_grown_twice_and_few_before_many(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = recorded(monkeypatch)
    router, question, query = asked()
    tried = [q.tobytes() for batch in Course(router, question, query).batches() for q in batch.initial]
    assert len(calls) == len(set(calls)) > 10
    for legs in {legs for legs, _ in calls}:
        widths = [beam.width for other, beam in calls if other == legs]
        assert widths == sorted(widths)
    beams = [beam for _, beam in calls]
    assert beams.index(ONE) < beams.index(FEW) < beams.index(MANY)
    assert len(tried) == len(set(tried))


def test_where_several_are_wanted_chains_are_grown_after_all_searches(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = recorded(monkeypatch)
    router, question, query = asked(several=True)
    grown_at_then = [len(calls) for batch in Course(router, question, query).batches() if batch.then > 0]
    assert not any(grown_at_then[:-1])
    assert len(grown_at_then) > 3
    assert {beam for _, beam in calls} == {FEW}


def test_routes_that_are_alike_are_one_line() -> None:
    router, question, query = asked()
    course = Course(router, question, query)
    line = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.4), 30)
    near = line + np.array([0.9 * ALIKE * 0.1, 0.0, 0.0])
    far = line + np.array([1.1 * ALIKE * 0.1, 0.0, 0.0])
    for route, count in ((line, 1), (near, 1), (far, 2), (line[:, [1, 2, 0]], 3)):
        course._note(route, True)
        assert len(course._lines) == count


def test_a_table_that_is_too_small_is_made_larger_before_anything_else(monkeypatch: pytest.MonkeyPatch) -> None:
    router, question, query = asked()
    plans: list[Plan] = []

    def full(self: Router, problem: Problem, query: Floats, plan: Plan, seconds: float) -> Found:
        plans.append(plan)
        return Found([], FULL, 10)

    monkeypatch.setattr(Router, "find", full)
    monkeypatch.setattr(Router, "by_edges", lambda *_: None)
    assert any(plans for _ in Course(router, question, query).batches())
    assert [plan.cells for plan in plans] == list(CELLS[:-1])
    assert len({plan.cell for plan in plans}) == 1


def test_a_full_table_of_fine_cells_is_followed_by_cells_between(monkeypatch: pytest.MonkeyPatch) -> None:
    router, question, query = asked(robot=Robot.uniform(5, length=(0.8, 1.2), max_bend=2.4, radius=0.05))
    plans: list[Plan] = []
    through = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.4), 40)

    def found(self: Router, problem: Problem, query: Floats, plan: Plan, seconds: float) -> Found:
        plans.append(plan)
        return Found([through.copy()], FOUND, 10) if len(plans) == 1 else Found([], FULL, 10)

    monkeypatch.setattr(Router, "find", found)
    monkeypatch.setattr(Router, "by_edges", lambda *_: None)
    monkeypatch.setattr(Course, "_try", lambda *_: iter(()))
    assert any(len(plans) > 3 for _ in Course(router, question, query).batches())
    coarse, fine = router.plans[0].cell, router.plans[-1].cell
    assert [plan.cell for plan in plans[:4]] == [coarse, fine, 2.0 * fine, fine]
    assert [plan.cells for plan in plans[:4]] == [*3 * [CELLS[0]], CELLS[1]]


@pytest.mark.parametrize(("share", "first"), [(0.95, "laid"), (1.05, "glance")])
def test_a_chain_that_has_to_be_stowed_is_led_through_gates_first(
    share: float, first: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    router, question, query = asked()
    calls: list[str] = []
    shortest = sum(segment.length[0] for segment in ROBOT.segments)
    route = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, shortest / (share * STOWED)), 40)

    def glanced(*_: object) -> Iterator[Batch]:
        calls.append("glance")
        return iter(())

    def laid(*_: object) -> Floats:
        calls.append("laid")
        return np.zeros((1, len(ROBOT), 3))

    monkeypatch.setattr(Course, "_try", glanced)
    monkeypatch.setattr(Router, "fit", laid)
    list(Course(router, question, query)._laid([route], finest=True))
    assert calls[0] == first


def test_a_leg_is_looked_for_around_edges_in_any_direction_before_over_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    asked_for: list[tuple[str, bool]] = []
    tip, elbow = Target((0, 0, 4.4)), Target((0.4, 0.0, 2.0), segment=2)
    router = Router(ROBOT, SCENE, Tolerance().for_robot(ROBOT))
    question = Question(Problem(ROBOT, [elbow, tip], SCENE), np.empty((0, len(ROBOT), 3)), lambda: 60.0)
    query = router.query(question.problem)
    assert query is not None
    course = Course(router, question, query)

    def around(query: Floats) -> Floats | None:
        first = not asked_for
        asked_for.append(("edges", bool(query[QUERY_AXIS : QUERY_AXIS + 3].any())))
        return np.linspace((0.0, 0.0, 0.0), (0.4, 0.0, 2.0), 20) if first else None

    def found(query: Floats, plan: Plan) -> Found:
        asked_for.append(("cells", bool(query[QUERY_AXIS : QUERY_AXIS + 3].any())))
        return Found([], FULL, plan.cells)

    monkeypatch.setattr(course, "_around", around)
    monkeypatch.setattr(course, "_found", found)
    assert course._search_legs(finest=True) is None
    assert [kind for kind, _ in asked_for[:3]] == ["edges"] * 3
    assert [axis for _, axis in asked_for[1:3]] == [True, False]
    assert {kind for kind, _ in asked_for[3:]} == {"cells"}
    assert [axis for _, axis in asked_for[3:]] == sorted((axis for _, axis in asked_for[3:]), reverse=True)


@pytest.mark.parametrize(
    ("other", "share"),
    [
        (Capsule((3, 0, 0), (3, 0, 1), 0.2), AMONG_BALLS),
        (Box((3, 0, 0), (0.2, 0.2, 0.2)), SHARE),
        (Sphere((0, 0, 0), 9.0, inside=True), SHARE),
    ],
)
def test_among_balls_alone_more_starts_are_scattered(other: Obstacle, share: float) -> None:
    scene = Scene([*SCENE.obstacles, other])
    router = Router(ROBOT, scene, Tolerance().for_robot(ROBOT))
    question = Question(Problem(ROBOT, TARGET, scene), np.empty((0, len(ROBOT), 3)), lambda: 60.0)
    query = router.query(question.problem)
    assert query is not None
    course = Course(router, question, query)
    course._spent = 100
    assert course._scattered(5).then == round(100 * share)
    assert course._scattered(5).then == 5


def test_what_is_cheap_is_tried_first() -> None:
    for grows, gates, finest in [(True, True, True), (True, True, False), (True, False, True), (False, False, True)]:
        chores = chores_of(grows, gates, finest, 8)
        costs = [chore.cost for chore in chores]
        assert costs == sorted(costs)
        assert len(chores) == len({(chore.beam, chore.which) for chore in chores})
        assert any(chore.beam is not None for chore in chores) == grows
        assert any(chore.which == 0 and chore.beam == GLANCE for chore in chores) == gates


def test_costs_grow_with_what_is_tried() -> None:
    costs = list(GROWN.values())
    assert costs == sorted(costs)
    assert [beam.width for beam in GROWN] == sorted(beam.width for beam in GROWN)
    assert list(GATES.values()) == sorted(GATES.values())
    assert [beam.width for beam in GATES] == sorted(beam.width for beam in GATES)
    assert list(GATES) == list(STARTS)
