"""Where motions begin: a little beyond limits, as rounding leaves shapes, they are brought within; farther, refused."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import Floats, refused

ROBOT = sn.Robot.uniform(3, (40.0, 80.0), max_bend=1.6, radius=3.0)
CURVED = sn.Robot.uniform(3, (40.0, 80.0), max_bend=1.6, max_curvature=0.02)
LIMITED = sn.Robot([sn.Segment(60.0, max_bend=2.0, tendons=sn.Tendons(3, 4.0, displacement=(-4.0, 3.0)))] * 3)
PULLED = sn.Robot(
    [sn.Segment(60.0, stiffness=2000.0, tendons=sn.Tendons(3, 4.0, stiffness=50.0, tension=(0.0, 6.0)))] * 2
)

PLANAR = sn.Robot(
    [sn.Segment((40.0, 80.0), (-0.5, 1.2), plane=0.7), sn.Segment((40.0, 80.0), 1.6), sn.Segment(60.0, 1.6)]
).locked({3: (0.6, -0.2, None)})
KINDS = {"bends": ROBOT, "curvature": CURVED, "tendons": LIMITED, "tensions": PULLED, "planes and locks": PLANAR}


def beyond(robot: sn.Robot, count: int) -> Floats:
    random = np.random.default_rng(2)
    q = random.normal(0.0, 1.5, (count, len(robot), 3))
    low, high = np.array([segment.length for segment in robot.segments]).T
    q[..., 2] = random.uniform(low - 3.0, high + 3.0, q.shape[:2])
    return q


@pytest.mark.parametrize("robot", KINDS.values(), ids=KINDS)
def test_clamp_finds_the_nearest_within_all_limits(robot: sn.Robot) -> None:
    random, scale = np.random.default_rng(3), np.array([1.0, 1.0, robot.mean_length / len(robot)])
    q = beyond(robot, 12)
    found = robot.clamp(q)
    for one, nearest in zip(q, found, strict=True):
        assert robot.violations(nearest) == []
        apart = np.linalg.norm((nearest - one) / scale)
        around = nearest + random.normal(0.0, 0.02, (40, *one.shape)) * scale
        for beside in robot.drive.coordinates.project(around):
            assert robot.violations(beside) or np.linalg.norm((beside - one) / scale) > apart - 1e-9
    np.testing.assert_array_equal(robot.clamp(found), found)


@pytest.mark.parametrize("rest", [(0.0, 0.0), (0.2, 0.1)])
def test_clamp_brings_thick_segments_in_planes_within_from_no_length(rest: tuple[float, float]) -> None:
    """Where a segment has no length, its curvature allows no bend to either side."""
    thick = sn.Robot([sn.Segment((40.0, 60.0), 1.0, radius=2.0, plane=0.3, rest=rest)])
    found = thick.clamp([[0.3, 0.3, 0.0]])
    np.testing.assert_allclose(found, thick.clamp([[0.3, 0.3, 40.0]]), atol=1e-9)


@pytest.mark.parametrize("robot", [ROBOT, LIMITED, PULLED], ids=["bends", "tendons", "tensions"])
def test_starts_that_went_through_float32_are_brought_within(robot: sn.Robot) -> None:
    for q in robot.clamp(beyond(robot, 6)):
        start = (q * (1.0 + 1e-7)).astype(np.float32).astype(np.float64)
        goal = np.where([True, True, False], 0.9 * q, q)
        planned = sn.plan(robot, start, goal)
        assert planned.solved, planned.worst
        assert robot.violations(planned.q[0]) == []
        assert bool(planned.notes) == (robot.excess(start) > 1e-9)
        assert np.abs(planned.q[0] - start).max() < 1e-4
        tracked = sn.track(robot, [sn.Target(robot.tip(goal)[:3, 3])], start=start)
        assert tracked.status != "start_blocked"
        assert tracked.notes == planned.notes


def test_what_is_said_of_starts_goals_and_knots() -> None:
    q = np.tile([1.0, 0.0, 60.0], (3, 1))
    hair, near, far = (q * [most, 1.0, 1.0] for most in (1.6 + 1e-11, 1.6 + 1e-5, 1.7))
    assert sn.plan(ROBOT, q, near).notes[0].startswith("goal: bend of segment")
    motion = sn.Motion(ROBOT, [q, near, near])
    assert motion.notes[0].startswith("q[1]: bend of segment")
    assert motion.notes[1:] == ("q: 1 more knots are brought within limits",)
    assert ROBOT.violations(motion.q[1]) == []
    assert sn.Motion(ROBOT, [q, hair]).notes == ()
    beyond = sn.plan(ROBOT, far, q)
    assert beyond.status == "start_blocked"
    assert "robot.clamp(start)" in beyond.notes[0]
    refused("goal", lambda: sn.plan(ROBOT, q, far), "robot.clamp")
    refused("q[1]", lambda: sn.Motion(ROBOT, [q, far]), "robot.clamp")


@pytest.mark.parametrize("by", [1e-9, 1e-3, 0.3])
def test_solves_and_steps_from_beyond_end_within_or_no_farther(by: float) -> None:
    q = np.tile([1.6 + by, 0.0, 60.0], (3, 1))
    target: Any = sn.Target(ROBOT.tip(ROBOT.clamp(q))[:3, 3])
    found = sn.solve(ROBOT, target, initial=q)
    assert found.solved
    assert ROBOT.violations(found.q) == []
    step = sn.Solver(ROBOT).step(q, [30.0, 0.0, 10.0], 0.1)
    assert ROBOT.excess(step.q) <= ROBOT.excess(q) + 1e-12
