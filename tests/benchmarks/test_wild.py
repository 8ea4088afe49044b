"""Wild problems: what is hidden is a solution, an honest answer is not accused, and every kind of lie is seen once."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from benchmarks.harness import Trial
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import target_errors, within_limits
from benchmarks.judges.kinematics import thicker
from benchmarks.judges.self_collision import look
from benchmarks.wild import calls, experiment, worlds
from benchmarks.wild.experiment import (
    CLEARANCE,
    DEMAND,
    LIMITS,
    OVERLAP,
    SELF_OVERLAP,
    TARGET,
    examine,
    refuted,
    solutions_of,
)
from benchmarks.wild.worlds import Judged, World
from sinuous.kernels.tables import BASE_BLOCKED, NO_ROUTE, OUT_OF_REACH, TARGET_BLOCKED
from sinuous.statics.rest import bodies_at
from tests.benchmarks.tampering import moved

ROBOT = sn.Robot.uniform(3, (0.9, 1.1), 6.0, radius=0.1)
STRAIGHT = np.array([[[0.0, 0.0, 1.0]] * 3])
BESIDE = [sn.Sphere((0.5, 0.0, 1.5), 0.3)]


def world(obstacles: list[Any], tolerance: float = 1e-6) -> World:
    targets = [[sn.Target((0.0, 0.0, 3.0), direction=(0.0, 0.0, 1.0))]]
    return World(ROBOT, sn.Scene(obstacles), sn.Tolerance(tolerance, tolerance), targets, STRAIGHT)


@pytest.fixture(scope="module")
def solution() -> sn.Solution:
    ((found, _),) = solutions_of(world(BESIDE))
    assert isinstance(found, sn.Solution)
    assert found.solved
    return found


def changed(solution: sn.Solution, **record: Any) -> sn.Solution:
    outcome = solution._outcome._replace(**record)
    return sn.Solution(solution.problem, outcome, solution.seconds, solution._resolver, solution._given)


def kinds(asked: World, said: sn.Solution) -> set[str]:
    return set(refuted(asked, {0: said})[0])


def test_answers_that_lie_are_accused_of_what_is_wrong(solution: sn.Solution) -> None:
    assert kinds(world(BESIDE), solution) == set()
    assert kinds(world(BESIDE), moved(solution, (0, 2), 3e-6)) == {TARGET}
    assert LIMITS in kinds(world(BESIDE, 1.0), moved(solution, (0, 2), 0.3))
    assert kinds(world([sn.Sphere((0.5, 0.0, 1.5), 0.41)]), solution) >= {OVERLAP}
    assert kinds(world([sn.Sphere((0.5, 0.0, 1.5), 0.39)]), solution) == {CLEARANCE}
    assert kinds(world(BESIDE), changed(solution, clearance=0.11)) == {CLEARANCE}
    knot = np.array([[0.0, 0.0, 1.0], [5.9, 0.0, 1.0], [0.0, 0.0, 1.0]])
    assert kinds(world([], 10.0), changed(solution, q=knot)) >= {SELF_OVERLAP}
    assert kinds(world([sn.Sphere((0.5, 0.0, 1.5), 0.41)]), changed(solution, code=2)) == set()  # not solved: no claim


def test_what_is_demanded_and_not_kept_is_seen(solution: sn.Solution) -> None:
    """The ball is 0.1 from the body."""
    for demand, false in ((0.0999, set()), (0.1001, {DEMAND})):
        assert kinds(replace(world(BESIDE), robot=ROBOT.changed(clearance=demand)), solution) == false
    unsure = replace(world(BESIDE), robot=ROBOT.changed(uncertainty=sn.Uncertainty(0.01)))
    assert kinds(unsure, changed(solution, clearance=0.0899)) == set()
    assert kinds(unsure, changed(solution, clearance=0.0901)) == {CLEARANCE}


@pytest.mark.parametrize("code", [OUT_OF_REACH, TARGET_BLOCKED, BASE_BLOCKED, NO_ROUTE])
def test_what_is_called_impossible(solution: sn.Solution, code: int) -> None:
    said = changed(solution, code=code)
    assert kinds(world(BESIDE), said) == {str(said.status)}


def test_what_is_late_or_false_is_not_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    made = [Trial(i, seconds, "solved") for i, seconds in enumerate((0.1, 0.5, 1.5))] + [
        Trial(3, 0.1, "solved", OVERLAP)
    ]
    monkeypatch.setattr(experiment, "examine", lambda _: made)
    part = experiment.tallied(lambda number: world([]), range(7, 8))
    within, false = experiment.lines_of("s", "w", 99.97, part)
    assert (within.solved, within.held) == ((2, 4), False)
    assert within.note == "not within 1 s: 7.2 (solved), 7.3 (overlap)"
    assert (false.reached, false.held, false.note) == (1, False, "7.3 (overlap)")


MAKERS = [
    *(partial(worlds.make, 3, number) for number in range(10)),
    *(partial(make, 3, number) for make in worlds.AUDITED.values() for number in range(3)),
]


@pytest.mark.parametrize("make", MAKERS)
def test_what_is_hidden_is_a_solution(make: Callable[[], World]) -> None:
    made = make()
    robot, q = made.robot, made.hidden
    assert 1 <= len(made.targets) == len(q)
    assert within_limits(robot, q).all()
    body, shapes = bodies_at(robot, q) if made.loaded else (robot, q)
    for targets in zip(*made.targets, strict=True):
        position, angle = target_errors(body, targets, shapes)
        assert (position <= 1e-9 * robot.mean_length + 1e-12 * np.abs(robot.base).max()).all()
        assert (angle <= 1e-7).all()
    if made.possible:
        assert (look(body, shapes, 0.0).least > 0.0).all()
        assert (Clearances(body, made.truth or made.scene).least(shapes, 0.0) > 0.0).all()


def test_the_judge_knows_distances_to_huge_obstacles_to_the_last_digits_of_the_robot() -> None:
    """A wall 1e10 away, and a ball of radius 1e10, that are 1e-7 away: in double precision the gap is lost."""
    robot, straight = sn.Robot([sn.Segment(1.0, 1.0, radius=0.1)]), np.array([[[0.0, 0.0, 1.0]]])
    for gap in (1e-7, -1e-7):
        wall = sn.HalfSpace((0.0, 1e10, 1.1 + gap), (0.0, 0.0, -1.0))
        assert Clearances(robot, sn.Scene([wall])).least(straight)[0] == pytest.approx(gap, abs=1e-15)
    ball = sn.Sphere((0.0, 0.0, 1e10 + 1.1 + 2e-6), 1e10)
    exact = ball.center[2] - 1e10 - 1.1
    assert Clearances(robot, sn.Scene([ball])).least(straight)[0] == pytest.approx(exact, abs=1e-9)


@pytest.mark.parametrize("make", [worlds.make, worlds.loaded], ids=["free", "loaded"])
def test_some_worlds_are_solved_and_hold(make: Callable[[int, int], World]) -> None:
    assert not [trial.wrong for number in range(4) for trial in examine(make(0, number)) if trial.wrong]


@pytest.mark.parametrize("kind", [k for k in experiment.KINDS if k.split()[0] not in ("timed", "tracked", "arms")])
def test_a_proof_of_a_motion_that_is_none_is_found_out(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    made = experiment.KINDS[kind]
    found = [made(0, number) for number in range(4)]
    assert all(each.false == "" for each in found)
    assert any(each.good for each in found)
    for name in ("needed_body", "self_body"):
        monkeypatch.setattr(f"benchmarks.judges.judge.{name}", lambda robot: thicker(robot, 5.0 * robot.mean_length))
    assert any(made(0, number).false for number in range(4))


def test_a_trajectory_that_leaves_its_limits_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    number = next(number for number in range(20) if experiment.timed_motion(0, number) == Judged(True, ""))
    at = sn.Trajectory.at
    monkeypatch.setattr(sn.Trajectory, "at", lambda self, t: at(self, t) * [1.0, 1.0, 1.0 + 1e-6])
    assert experiment.timed_motion(0, number).false in ("limits", "rates")


def test_the_loaded_body_is_judged() -> None:
    rod = sn.Segment((0.8, 1.0), 2.0, radius=0.02, stiffness=sn.Stiffness(0.5), mass=0.01, arcs=3)
    robot = sn.Robot([rod] * 2, base=sn.pose((0, 0, 0), direction=(1, 0, 0)), gravity=(0, 0, -9.81))
    q = np.array([[[0.0, 0.0, 1.0]] * 2])
    sunk = robot.shape(q[0]).tip[:3, 3]
    assert sunk[2] < -0.1
    held = World(robot, sn.Scene(), sn.Tolerance(), [[sn.Target(sunk)]], q, loaded=True)
    straight, low = sn.Scene([sn.Sphere((2.0, 0.0, 0.0), 0.05)]), sn.Scene([sn.Sphere(sunk, 0.05)])
    assert experiment._refuted(held, straight, q) == ""
    assert experiment._refuted(held, low, q) == "overlap"
    assert experiment._refuted(held, straight, 1.1 * q) == "limits"


@pytest.mark.parametrize(
    ("error", "false"),
    [
        (None, ""),
        (sn.InputError("rates[2]", "", 1, "2"), ""),
        (sn.InputError("scene", "", 1, "2"), ""),
        (sn.InputError("initial", "", 1, "2"), "InputError"),
        (IndexError("out of range"), "IndexError"),
        (AssertionError("no"), "AssertionError"),
    ],
)
def test_a_call_ends_in_an_answer_or_in_a_refusal(
    error: Exception | None, false: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def make(*_: Any) -> None:
        if error is not None:
            raise error

    monkeypatch.setattr(calls, "CALLS", {"call": (make, ("rates",))})
    found = calls.called(0, 0)
    assert (found.good, found.false.split(" ")[:2]) == (error is None, ["call:", false] if false else [""])
    _, line = experiment.lines_of_judged("s", "calls", "answered", "exceptions", [found, Judged(True, "")])
    assert line.reached == bool(false)


def test_a_chamber_of_a_rigid_segment_has_no_tension_and_no_blame() -> None:
    assert calls.called(56, 213) == Judged(True, "")
