"""The slow path agrees with the fast one, and finds every kind of fault."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.arguments import SelfCollision
from sinuous.measures.body import segment_ends
from sinuous.problem.problem import Problem
from sinuous.solution import verification

ROBOT = sn.Robot.uniform(4, (0.8, 1.2), 2.0, radius=0.1, base=sn.pose((1, 2, 3), direction=(1, 1, 0)))
Q = np.array([[0.5, 0.2, 1.0], [-0.7, 0.4, 0.9], [0.0, 1.1, 1.1], [0.3, -0.3, 1.0]])


def test_poses_agree_with_the_kernels() -> None:
    ends = segment_ends(ROBOT, Q)
    np.testing.assert_allclose(ends[1:], ROBOT.forward(Q), atol=1e-13)


def problem(**changes: Any) -> Problem:
    pose = ROBOT.tip(Q)
    targets = changes.get("targets", sn.Target(pose[:3, 3], rotation=pose[:3, :3]))
    return Problem(ROBOT, targets, changes.get("scene"), sn.Tolerance(1e-4, 1e-3))


def test_a_right_answer_is_accepted() -> None:
    assert verification.verify(problem(), Q).ok


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


def test_a_broken_limit_is_found() -> None:
    straight = np.array([[0, 0, 1.3], [0, 0, 1], [0, 0, 1], [0, 0, 1]], np.float64)
    check = verification.verify(problem(targets=sn.Target(ROBOT.tip(straight)[:3, 3])), straight)
    assert not check.ok
    assert check.excess == pytest.approx(0.1)


def test_an_overlap_is_found_and_named() -> None:
    place = ROBOT.backbone(Q, 20)[50]
    check = verification.verify(problem(scene=[sn.Sphere(place, 0.05, name="pea")]), Q)
    assert not check.ok
    assert (check.segment, check.obstacle) == (3, "pea")
    assert check.clearance == pytest.approx(-0.15, abs=1e-3)


CURLED = np.array([[2.7, 0.1, 1.0], [2.6, 0.0, 1.0], [2.6, 0.1, 1.0]])


def through_itself(word: SelfCollision) -> Problem:
    robot = sn.Robot.uniform(3, (0.8, 1.2), 3.0, radius=0.15, self_collision=word)
    return Problem(robot, sn.Target(robot.tip(CURLED)[:3, 3]))


def test_a_body_that_runs_through_itself_is_found_and_named() -> None:
    check = verification.verify(through_itself("avoid"), CURLED)
    assert not check.ok
    assert check.self_clearance < -0.1
    assert check.self_segments is not None
    worst = verification.find_worst(through_itself("avoid"), CURLED, True)
    assert (worst.other_segment, worst.segment) == check.self_segments
    assert worst.constraint == "self_clearance"
    assert worst.amount == pytest.approx(-check.self_clearance, rel=1e-3)
    assert str(worst) == f"segment {worst.segment} touches segment {worst.other_segment}, {worst.amount:.3g} too near"


def test_it_may_run_through_itself_where_that_is_allowed() -> None:
    check = verification.verify(through_itself("allow"), CURLED)
    assert (check.ok, check.self_clearance, check.self_segments) == (True, np.inf, None)
