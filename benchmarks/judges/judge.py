"""Independent judges: an answer counts only once it was found right here. Nothing in this file calls a kernel.

Is an answer at its target, within limits, and clear? Is a motion as clear as it claims, by sampling?
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.judges.clearances import GRACE, Clearances, overlaps
from benchmarks.judges.kinematics import arm_of, bend_caps, moving, needed_body, segment_ends, self_body
from benchmarks.judges.self_collision import look
from sinuous.base.checks import Floats
from sinuous.model.actuators import Lines
from sinuous.model.robot import Robot

Flags = NDArray[np.bool_]

IMPOSSIBLE = (sn.Status.OUT_OF_REACH, sn.Status.TARGET_BLOCKED, sn.Status.BASE_BLOCKED, sn.Status.NO_ROUTE)
"""What no problem with a hidden solution may be called."""

LIMIT_SLACK = 1e-9
"""How far outside its limits a configuration may be: rad, or of the robot's mean length; of joints, of their limits."""

ROUNDING = 1e-12
"""What two computations of one error may differ by: rad, or of the longest length of the robot."""


def right(
    robot: sn.Robot, targets: Sequence[sn.Target], q: Floats, tolerance: sn.Tolerance, scene: sn.Scene | None = None
) -> Flags:
    """Say of configurations (m, n, 3), one a target, whether each is at it, within limits, and clear of obstacles."""
    good = at_targets(robot, targets, q, tolerance) & within_limits(robot, q)
    return good if scene is None or not len(scene) else np.asarray(good & ~overlaps(robot, scene, q))


def at_targets(robot: sn.Robot, targets: Sequence[sn.Target], q: Floats, tolerance: sn.Tolerance) -> Flags:
    """Say of configurations (m, n, 3), one a target, whether each is at it."""
    position, angle = target_errors(robot, targets, q)
    allowed = tolerance.for_robot(robot).position or 0.0
    return np.asarray((position <= allowed + ROUNDING * robot.longest) & (angle <= tolerance.angle + ROUNDING))


def target_errors(robot: sn.Robot, targets: Sequence[sn.Target], q: Floats) -> tuple[Floats, Floats]:
    """Distances (m,) and angles (m,) of configurations (m, n, 3) to one target each; 0 where nothing is asked."""
    ends = segment_ends(robot, q)[:, 1 if robot.segments else 0 :].copy()
    ends[:, -1] = ends[:, -1] @ robot.tool
    pairs = [(ends[i, -1 if t.segment is None else t.segment - 1], t) for i, t in enumerate(targets)]
    position = [0.0 if t.position is None else float(np.linalg.norm(p[:3, 3] - t.position)) for p, t in pairs]
    return np.array(position), np.array([_angle(p[:3, :3], t) for p, t in pairs])


def _angle(rotation: Floats, target: sn.Target) -> float:
    if target.direction is not None:
        tangent = rotation[:, 2]
        apart, together = np.linalg.norm(tangent - target.direction), np.linalg.norm(tangent + target.direction)
        return float(2.0 * np.arctan2(apart, together))
    if target.rotation is not None:
        return float(Rotation.from_matrix(rotation.T @ target.rotation).magnitude())
    return 0.0


def within_limits(robot: sn.Robot, q: Floats) -> Flags:
    """Say for every configuration (m, n, 3) if joints, lengths, bends, curvatures and actuators keep their limits."""
    if robot.joints:
        values, own = robot.split(q)
        low, high = np.array([joint.limits for joint in moving(robot.joints)]).T
        slacks = LIMIT_SLACK * (1.0 + abs(low)), LIMIT_SLACK * (1.0 + abs(high))
        held: Flags = ((values >= low - slacks[0]) & (values <= high + slacks[1])).all(axis=1)
        arm = arm_of(robot)
        return held if arm is None else np.asarray(held & within_limits(arm, own))
    lengths, bends = q[..., 2], np.hypot(q[..., 0], q[..., 1])
    low, high = np.array([segment.length for segment in robot.segments]).T
    slack = LIMIT_SLACK * robot.mean_length
    good = (lengths >= low - slack) & (lengths <= high + slack) & (bends <= bend_caps(robot, lengths) + LIMIT_SLACK)
    result: Flags = good.all(axis=1) & np.isfinite(q).all(axis=(1, 2)) & actuators_within(robot, q, slack)
    return result


def actuators_within(robot: Robot, q: Floats, slack: float) -> Flags:
    """Say for every configuration (m, n, 3) whether all tendons and chambers keep their limits, to within a length."""
    good = np.ones(len(q), bool)
    bends = np.cumsum(q[..., :2], axis=1)
    for k, segment in enumerate(robot.segments):
        if segment.tendons is not None:
            low, high = segment.tendons.displacement
            good &= _between(_pulled(segment.tendons, bends[:, k]), low, high, slack)
        if segment.chambers is not None:
            low, high = segment.chambers.length
            good &= _between(q[:, k, 2:] - _pulled(segment.chambers, q[:, k, :2]), low, high, slack)
    return good


def _pulled(lines: Lines, bends: Floats) -> Floats:
    """By how much bends (m, 2) shorten each line (m, lines): its distance from the backbone, times the bend its way."""
    angle, side = np.hypot(bends[:, 0], bends[:, 1]), np.arctan2(bends[:, 1], bends[:, 0])
    return np.asarray(lines.radius * angle[:, None] * np.cos(side[:, None] - lines.angles))


def _between(values: Floats, low: float, high: float, slack: float) -> Flags:
    return np.asarray((values >= low - slack).all(axis=1) & (values <= high + slack).all(axis=1))


A_STEP = 50
"""Configurations that are looked at in every step."""

EXCESS = 1e-6
"""By how much of itself a rate may seem to be exceeded, by differences."""


def samples(knots: Floats, count: int | None = None) -> Floats:
    """Return configurations (m, n, 3) on the way through knots (T, n, 3), so many a step, and the last."""
    count = A_STEP if count is None else count
    t = np.arange(count)[:, None, None] / count
    steps = [(1.0 - t) * one + t * other for one, other in pairwise(knots)]
    return np.concatenate([*steps, knots[-1:]])


def wrong_in(robot: sn.Robot, scene: sn.Scene, knots: Floats, count: int | None = None) -> str:
    """Say what is wrong with a motion through knots (T, n, 3); or nothing. See `wrong_at`."""
    return wrong_at(robot, scene, samples(knots, count))


def wrong_at(robot: sn.Robot, scene: sn.Scene, q: Floats) -> str:
    """Say what is wrong with configurations (m, n, 3): limits, an obstacle, the body itself; or nothing."""
    if not within_limits(robot, q).all():
        return "limits"
    return overlap(robot, scene, q, GRACE * robot.mean_length)


def overlap(body: sn.Robot, scene: sn.Scene, q: Floats, slack: float) -> str:
    """Say whether a body in configurations (m, n, 3) overlaps an obstacle or itself by more than `slack`."""
    if len(scene) and Clearances(needed_body(body), scene).least(q, 0.0).min() < -slack:
        return "overlap"
    if body.self_collision == "avoid" and look(self_body(body), q, 0.0).least.min() < -slack:
        return "overlap with itself"
    return ""


def too_fast(change: Floats, seconds: Floats | float, bend: float, length: float) -> bool:
    """Whether changes (m, n, 3) of configurations, each in so many seconds, exceed rates of bends and lengths."""
    rates = change / np.reshape(seconds, (-1, 1, 1))
    bends, lengths = np.hypot(rates[..., 0], rates[..., 1]).max(), np.abs(rates[..., 2]).max()
    return bool(bends > bend * (1.0 + EXCESS) or lengths > length * (1.0 + EXCESS))
