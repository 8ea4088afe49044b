"""The slow path agrees with the fast one, finds every kind of fault, and judges shapes from elsewhere as solutions."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.answer import verification
from sinuous.answer.worst import find_worst
from sinuous.base.arguments import SelfCollision
from sinuous.measures.following import least_clearances
from tests.helpers import present, refused

ROBOT = sn.Robot.uniform(4, (0.8, 1.2), 2.0, radius=0.1, base=sn.pose((1, 2, 3), direction=(1, 1, 0)))
Q = np.array([[0.5, 0.2, 1.0], [-0.7, 0.4, 0.9], [0.0, 1.1, 1.1], [0.3, -0.3, 1.0]])


def problem(**changes: Any) -> sn.Problem:
    pose = ROBOT.tip(Q)
    targets = changes.get("targets", sn.Target(pose[:3, 3], rotation=pose[:3, :3]))
    return sn.Problem(ROBOT, targets, changes.get("scene"), sn.Tolerance(1e-4, 1e-3))


def test_obstacles_that_move_are_refused() -> None:
    ball = sn.Moving(sn.Sphere((0.0, 0.0, 0.0), 0.3), [0, 1], [(2, 0, 1), (0.5, 0, 1)])
    refused("scene", lambda: sn.check(ROBOT, Q, [ball]), "sphere[0] moves; expected the scene at one time")


def test_a_wrong_position_is_found() -> None:
    moved = Q.copy()
    moved[-1, 2] += 2e-4
    check = verification.verify(problem(), moved)
    assert not check.ok
    assert check.position_error == pytest.approx(2e-4, rel=2e-2)


def test_a_wrong_angle_is_found() -> None:
    pose = ROBOT.tip(Q)
    for target in (sn.Target(direction=pose[:3, 2]), sn.Target(rotation=pose[:3, :3])):
        check = verification.verify(problem(targets=target), Q + np.array([0.01, 0, 0]))
        assert not check.ok
        assert check.angle_error > 0.002


def test_an_overlap_is_found_and_named() -> None:
    place = ROBOT.backbone(Q, 20)[50]
    check = verification.verify(problem(scene=[sn.Sphere(place, 0.05, name="pea")]), Q)
    assert not check.ok
    assert (check.segment, check.obstacle) == (3, "pea")
    assert check.clearance == pytest.approx(-0.15, abs=1e-3)


CURLED = np.array([[2.7, 0.1, 1.0], [2.6, 0.0, 1.0], [2.6, 0.1, 1.0]])


def through_itself(word: SelfCollision) -> sn.Problem:
    robot = sn.Robot.uniform(3, (0.8, 1.2), 3.0, radius=0.15, self_collision=word)
    return sn.Problem(robot, sn.Target(robot.tip(CURLED)[:3, 3]))


def test_a_body_that_runs_through_itself_is_found_and_named() -> None:
    check = verification.verify(through_itself("avoid"), CURLED)
    assert not check.ok
    assert check.self_clearance < -0.1
    worst = find_worst(through_itself("avoid"), CURLED, True)
    assert (worst.other_segment, worst.segment) == present(check.self_segments)
    assert worst.constraint == "self_clearance"
    assert worst.amount == pytest.approx(-check.self_clearance, rel=1e-3)
    whom = f"segment {worst.segment} touches segment {worst.other_segment}"
    assert str(worst) == f"{whom}, {worst.amount:.3g} too near, {worst.place}"


ARM = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.1)
BALL = sn.Sphere((0.0, 0.0, 2.0), 0.3, name="ball")
SHAPES = np.random.default_rng(0).uniform((-0.9, -0.9, 0.7), (0.9, 0.9, 1.2), (2, 4, 3, 3))
TIP = ARM.tip(SHAPES[0, 0])
TARGET = sn.Target(TIP[:3, 3], direction=TIP[:3, 2])


def test_one_shape_is_judged_as_a_solution_is() -> None:
    problem = sn.Problem(ARM, [TARGET, sn.Target((0, 0, 1), segment=1)], [BALL], sn.Tolerance(0.1, 0.2))
    found = sn.check(ARM, SHAPES[0, 1], [BALL], problem.targets, tolerance=sn.Tolerance(0.1, 0.2))
    assert found == verification.verify(problem, SHAPES[0, 1])
    assert sn.check(ARM, SHAPES[0, 0].tolist(), targets=TARGET).position_error < 1e-12


@pytest.mark.parametrize("scene", [None, [BALL]])
def test_a_batch_is_the_same_as_one_by_one(scene: Any) -> None:
    many: Any = sn.check(ARM, SHAPES, scene, TARGET)
    assert many.ok.shape == (2, 4)
    assert many.ok.dtype == bool
    for place in np.ndindex(2, 4):
        one = sn.check(ARM, SHAPES[place], scene, TARGET)
        for name, value in vars(one).items():
            assert getattr(many, name)[place] == value
    assert many.clearance.dtype == many.excess.dtype == float
    nothing: Any = sn.check(ARM, SHAPES[:0], scene)
    assert nothing.ok.shape == (0, 4)
    assert nothing.ok.dtype == bool


def test_bad_input_is_refused() -> None:
    three: Any = 3
    refused("robot", lambda: sn.check(three, SHAPES))
    refused("q", lambda: sn.check(ARM, SHAPES[..., :2]), "3, 3)")
    refused("q", lambda: sn.check(ARM, np.full((3, 3), np.nan)))
    refused("scene[0]", lambda: sn.check(ARM, SHAPES, [three]))
    refused("targets", lambda: sn.check(ARM, SHAPES, None, [three]))
    refused("targets.segment", lambda: sn.check(ARM, SHAPES, None, sn.Target((0, 0, 1), segment=4)))
    refused("tolerance", lambda: sn.check(ARM, SHAPES, tolerance=three))


@pytest.mark.parametrize("every", [1, 3])
def test_clearances_among_what_moves_are_those_at_each_time(every: int) -> None:
    rng, when = np.random.default_rng(0), np.linspace(0.0, 1.0, 9)
    boxes = [sn.Box(150.0 * rng.normal(size=3), rng.uniform(5.0, 20.0, 3)) for _ in range(20)]
    courses = [sn.Moving(box, [0.0, 1.0], 10.0 * rng.normal(size=(2, 3)), rng.normal(size=(2, 4))) for box in boxes]
    scene = sn.Scene([boxes[i] if i % every else courses[i] for i in range(20)]).snapshot()
    robot = sn.Robot.uniform(3, length=(45, 70), max_bend=2.4, radius=4)
    q = np.stack([[[0.5 * t, 0.3, 50.0], [1.0 - t, 0.2, 60.0], [t, -0.4, 55.0]] for t in when])
    each = [least_clearances(robot, scene.at(t), one[None]) for t, one in zip(when.tolist(), q, strict=True)]
    # Places are turned into the frame of an obstacle, not the obstacle to where it is: that rounds places of some 1e2,
    # and so distances.
    for found, expected in zip(least_clearances(robot, scene, q, when), zip(*each, strict=True), strict=True):
        np.testing.assert_allclose(found, np.concatenate(expected), rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("clearance", [0.003, (0.003, 0.003, 0.003), (0.001, 0.003, 0.004)])
@pytest.mark.parametrize("joints", [[], [sn.Prismatic((0.0, 0.0, 1.0), (0.0, 1.0))]])
def test_uncertainty_counts_however_clearance_is_given(clearance: Any, joints: Any) -> None:
    robot = sn.Robot([sn.Segment(0.1, 2.0, radius=0.01)] * 3, joints=joints, clearance=clearance)
    q, beside = robot.clamp(np.tile([0.0, 0.0, 0.1], (len(robot), 1))), [sn.Sphere((0.03, 0.0, 0.2), 0.015)]
    for unsure, ok in ((0.0004, True), (0.004, False)):  # 0.005 are left
        body = robot.changed(uncertainty=sn.Uncertainty(unsure))
        steps = sn.Motion(body, [q, q], beside).verify()
        assert sn.check(body, q, beside).ok == all(each.ok for each in steps) == ok
