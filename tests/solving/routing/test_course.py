"""The order of what is tried along routes: cheap before dear, and nothing twice."""

from typing import Any

import numpy as np
import pytest

from sinuous import Robot, Scene, Sphere, Target, Tolerance
from sinuous.checks import Floats
from sinuous.kernels.tables import FULL
from sinuous.problem.problem import Problem
from sinuous.solving.routing.course import ALIKE, GATES, GROWN, Course
from sinuous.solving.routing.crossing import STARTS
from sinuous.solving.routing.growth import FEW, MANY, ONE, Beam, grown
from sinuous.solving.routing.plans import CELLS, Plan
from sinuous.solving.routing.routes import Router
from sinuous.solving.routing.searches import Found
from sinuous.solving.starts.sources import Question

ROBOT = Robot.uniform(5, length=(0.8, 1.2), max_bend=2.4, radius=0.1)
SCENE = Scene([Sphere((0, 0, 2.2), 0.7), Sphere((0.9, 0.2, 3.1), 0.4)])
TARGET = Target((0, 0, 4.4))


def asked(several: bool = False) -> tuple[Router, Question, Floats]:
    router = Router(ROBOT, SCENE, Tolerance().for_robot(ROBOT))
    question = Question(Problem(ROBOT, TARGET, SCENE), np.empty((0, len(ROBOT), 3)), lambda: 60.0, several)
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
    next(iter(Course(router, question, query).batches()))
    assert [plan.cells for plan in plans] == list(CELLS[:-1])
    assert len({plan.cell for plan in plans}) == 1


def test_costs_grow_with_what_is_tried() -> None:
    costs = list(GROWN.values())
    assert costs == sorted(costs)
    assert [beam.width for beam in GROWN] == sorted(beam.width for beam in GROWN)
    assert list(GATES.values()) == sorted(GATES.values())
    assert [beam.width for beam in GATES] == sorted(beam.width for beam in GATES)
    assert list(GATES) == list(STARTS)
