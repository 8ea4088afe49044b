"""Every limit of shapes is told by all that verbs ask; and how the thickness of the body limits its curvature."""

import math
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.answer.verification import verify_steps
from sinuous.base.checks import Floats
from sinuous.kernels.tables import MAX_CURVATURE
from sinuous.model.robot import robot_group
from tests.helpers import refused_each
from tests.motion.test_table_of_limits import LIMITS, START

OUTSIDE: dict[str, tuple[Any, tuple[str, int | str]]] = {
    "joint": (([0.5, -0.04], START), ("bend", "roll")),
    "length": ([[0.1, 0.05, 0.13], START[1]], ("length", 1)),
    "bend": ([START[0], [0.05, -0.7, 0.1]], ("bend", 2)),
    "curvature": ([[0.45, 0.45, 0.1], START[1]], ("curvature", 1)),
    "actuator": ([[-0.45, 0.0, 0.1], [-0.45, 0.0, 0.1]], ("actuator", 2)),
    "tension": ([[-1.4, 0.0, 0.1], START[1]], ("actuator", 1)),
    "plane": ([[0.0, 0.3, 0.1], [0.0, 0.0, 0.1]], ("bend", 1)),
    "locked": ([START[0], [0.05, 0.1, 0.1]], ("bend", 2)),
}
"""A shape that violates one limit alone, and what that is called."""

OF_SHAPES = [limit for limit in LIMITS if not limit.startswith(("rate", "acceleration"))]


def outside_of(limit: str) -> tuple[sn.Robot, Floats, tuple[str, int | str]]:
    """A robot, a shape that violates its limit alone, and what that is called."""
    robot = LIMITS[limit]("elastic" if limit == "tension" else "free")
    shape, called = OUTSIDE[limit]
    return robot, robot.configuration("q", shape), called


@pytest.mark.parametrize("limit", OF_SHAPES)
def test_a_shape_outside_of_one_limit_is_told_by_all_that_verbs_ask(limit: str) -> None:
    robot, outside, called = outside_of(limit)
    within = robot.clamp(outside)
    for q, kept in ((within, True), (outside, False)):
        assert {(kind, where) for kind, where, _ in robot.violations(q)} == (set() if kept else {called})
        assert (robot.excess(q) <= 1e-11) == kept
        assert sn.check(robot, q, targets=sn.Target(robot.tip(q))).ok == kept  # so does `verify()` of a solution
        steps = verify_steps(robot, np.stack([within, q]), sn.Scene([]).snapshot(), np.arange(2.0))  # and of a motion
        assert [each.ok for each in steps] == [kept]


def test_the_radius_limits_the_curvature() -> None:
    segments = [
        sn.Segment((1.0, 2.0), 3.0, radius=0.5),
        sn.Segment(1.0, 3.0, max_curvature=1.5, radius=0.5),
        sn.Segment(1.0),
    ]
    robot = sn.Robot(segments)
    assert robot.curvatures[0] == pytest.approx(2.0, rel=1e-8)
    assert robot.curvatures[1:] == (1.5, math.inf)
    assert robot.curvatures[0] < 2.0
    np.testing.assert_array_equal(robot.limits[:, MAX_CURVATURE], robot.curvatures)
    through = sn.Robot(segments, self_collision="allow")
    assert through.curvatures == (math.inf, 1.5, math.inf)
    assert (robot.avoids_itself, through.avoids_itself) == (True, False)
    assert not sn.Robot([sn.Segment(1.0)]).avoids_itself
    assert (robot_group(robot)[2], robot_group(through)[2]) == (1.0, 0.0)


def test_a_bend_that_is_too_tight_is_a_violation_and_outside() -> None:
    robot = sn.Robot.uniform(2, (1.0, 2.0), 3.0, radius=0.5)
    q = np.array([[2.4, 0.0, 1.0], [2.4, 0.0, 1.3]])
    assert robot.excess(q) == pytest.approx(0.4)
    ((name, segment, amount),) = robot.violations(q)
    assert (name, segment) == ("curvature", 1)
    assert amount == pytest.approx(0.4)
    through = sn.Robot.uniform(2, (1.0, 2.0), 3.0, radius=0.5, self_collision="allow")
    assert (through.excess(q), through.violations(q)) == (0.0, [])


def test_only_two_words_are_understood() -> None:
    words = ("never", "", True, None, 1.0, ["avoid"])
    refused_each("self_collision", words, lambda word: sn.Robot.uniform(2, 1.0, self_collision=word), "avoid or allow")


def test_notes_name_segments_that_are_too_thick() -> None:
    thick, thin = sn.Segment((1.0, 2.0), 3.0, radius=0.5), sn.Segment((0.0, 2.0), 3.0, radius=0.1)
    robot = sn.Robot([thick, thick, thin, thick])
    assert robot.notes == (
        "segments 1 to 2: a radius of 0.5 is above the smallest radius of curvature, 0.3333; while self_collision is "
        "avoided, the bend at length 1 is at most 2 rad",
        "segment 4: a radius of 0.5 is above the smallest radius of curvature, 0.3333; while self_collision is "
        "avoided, the bend at length 1 is at most 2 rad",
    )
    assert sn.Robot([thick, thin], self_collision="allow").notes == ()
    assert sn.Robot([sn.Segment(2.0, 3.0, radius=0.5)]).notes == ()
