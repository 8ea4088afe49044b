"""Planes and locks hold at every knot of a motion and between them, and what a reach map says of them is true."""

from collections.abc import Callable

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats

PLANE = 0.6
"""Angle of the plane, rad."""

ALONG = np.array([np.cos(PLANE), np.sin(PLANE)])
ACROSS = np.array([-np.sin(PLANE), np.cos(PLANE)])
HELD = (0.3 * np.cos(PLANE), 0.3 * np.sin(PLANE), 40.0)
PLANAR = sn.Robot([sn.Segment((30.0, 60.0), (-1.0, 1.4), radius=2.0, plane=PLANE)] * 3)
ROBOTS = {"planar": PLANAR, "locked": PLANAR.locked({2: HELD})}
BALL = sn.Sphere((*(12.0 * ACROSS).tolist(), 75.0), 6.0)
SHARES = np.linspace(0.0, 1.0, 7)[:, None, None]


def shape(robot: sn.Robot, bends: list[float], lengths: list[float]) -> Floats:
    return robot.clamp(np.column_stack([np.outer(bends, ALONG), lengths]))


def off(name: str, q: Floats) -> float:
    """By how much shapes (..., 3, 3) are out of the plane, its limits and the lock, in plain arithmetic."""
    along, across = q[..., :2] @ ALONG, q[..., :2] @ ACROSS
    worst = max(np.abs(across).max(), along.max() - 1.4, -1.0 - along.min())
    if name == "locked":
        worst = max(worst, np.abs(q[..., 1, :] - HELD).max())
    return float(worst)


def plan(robot: sn.Robot) -> sn.Motion:
    begin = shape(robot, [0.9, 0.3, -0.3], [40.0, 40.0, 40.0])
    return sn.plan(robot, begin, shape(robot, [-0.5, 0.3, 0.8], [45.0, 40.0, 50.0]), [BALL], time=10.0)


def track(robot: sn.Robot) -> sn.Motion:
    ways = [shape(robot, [0.2 * i, 0.3, 0.5 - 0.2 * i], [40.0, 40.0, 45.0]) for i in range(3)]
    targets = [sn.Target(robot.tip(q)[:3, 3]) for q in ways]
    return sn.track(robot, targets, start=ways[0], time=2.0)


def from_elsewhere(robot: sn.Robot) -> sn.Motion:
    knots = [shape(robot, [0.3 * i, 0.3, -0.2 * i], [40.0 + i, 40.0, 45.0]) for i in range(4)]
    return sn.Motion(robot, knots)


def timed(robot: sn.Robot) -> sn.Motion:
    rates = sn.Rates(bend=1.0, length=20.0, acceleration=sn.Rates(bend=2.0, length=40.0))
    return from_elsewhere(robot).timed(rates).resampled(10.0)


VERBS: dict[str, Callable[[sn.Robot], sn.Motion]] = {
    "plan": plan,
    "track": track,
    "Motion": from_elsewhere,
    "timed": timed,
}


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("verb", VERBS)
def test_planes_and_locks_hold_at_knots_and_between(verb: str, name: str) -> None:
    motion = VERBS[verb](ROBOTS[name])
    assert motion.solved
    assert len(motion.q) > 1
    assert motion.verify().ok
    assert off(name, (1.0 - SHARES[..., None]) * motion.q[:-1] + SHARES[..., None] * motion.q[1:]) <= 1e-9


def test_a_map_reaches_only_the_plane() -> None:
    aims = np.array([(0.0, 0.0, 1.0), (*(0.8 * ALONG), 0.6)])
    found = sn.studies.reach(PLANAR, spacing=30.0, directions=aims, workers=1)
    middles = found.voxels.middles
    away = np.abs(middles[..., :2] @ ACROSS)
    assert found.reachable.any()
    assert (away[found.reachable] <= 15.0 * 3.0**0.5).all()


def test_a_plan_to_a_shape_off_the_plane_is_refused_in_a_line() -> None:
    begin, away = shape(PLANAR, [0.1, 0.1, 0.1], [40.0] * 3), np.array([[*(0.2 * ACROSS), 40.0]] * 3)
    with pytest.raises(sn.InputError, match=r"goal: bend of segment 1 is 0\.2 beyond its limit.*robot\.clamp"):
        sn.plan(PLANAR, begin, away, time=1.0)


@pytest.mark.parametrize(("way", "followed"), [(ALONG, True), (ACROSS, False)])
def test_a_leader_in_the_plane_is_followed_there_and_one_that_leaves_it_is_not(way: Floats, followed: bool) -> None:
    curve = [np.array([*(aside * way), up]) for aside, up in ((0, 0), (0, 30), (12, 70), (35, 95))]
    robot, budget = sn.on_stage(PLANAR, 120.0), 10.0 if followed else 1.0
    motion = sn.follow_the_leader(robot, sn.Curve.bezier(curve), time=budget, tip_deviation=1.0)
    assert motion.solved is followed
    assert off("planar", motion.q[:, 1:]) <= 1e-9


def test_a_segment_that_gives_way_leaves_its_plane_under_load_and_a_rigid_one_does_not() -> None:
    """Under load planes and locks hold for the drive; tendons in a plane do not hold what pulls across it."""
    soft = sn.Segment(0.1, (-1.0, 1.0), radius=0.004, plane=0.0, stiffness=sn.Stiffness(0.02, 0.015), mass=0.3)
    for other, gives in ((soft, True), (sn.Segment(0.1, (-1.0, 1.0), radius=0.004, plane=0.0, mass=0.3), False)):
        robot = sn.Robot([soft, other], gravity=(0.0, -9.81, 0.0))
        q = robot.clamp(np.array([[0.4, 0.0, 0.1], [0.3, 0.0, 0.1]]))
        assert robot.violations(q) == []
        across = abs(float(robot.shape(q).states[-1, 1]))
        assert across > 1e-4 if gives else across == 0.0
