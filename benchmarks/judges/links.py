"""Are joints and the links behind them where a motion may have them? By rotations about axes, without the kernels."""

import math
from itertools import combinations

import numpy as np
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.judges.primitives import distances_to
from sinuous.base.checks import Floats
from sinuous.model.joints import Fixed, Joint, Prismatic

PLACES = 25
"""Places along a capsule where it is looked at."""

ROUNDING = 1e-9
"""By how much limits and clearances may be missed, in rad and m."""


def moving(joints: tuple[Joint, ...]) -> list[Joint]:
    """Return the joints that have a value."""
    return [joint for joint in joints if not isinstance(joint, Fixed)]


def link_poses(robot: sn.Robot, values: Floats) -> Floats:
    """Poses (m, j, 4, 4) of the links after all joints, at values (m, v) of those that move."""
    at, poses, column = np.broadcast_to(robot.base, (len(values), 4, 4)), [], 0
    for joint in robot.joints:
        step = np.broadcast_to(np.eye(4), at.shape).copy()
        if not isinstance(joint, Fixed):
            own = values[:, column, None] * joint.axis
            column += 1
            if isinstance(joint, Prismatic):
                step[:, :3, 3] = own
            else:
                step[:, :3, :3] = Rotation.from_rotvec(own).as_matrix()
        at = at @ joint.origin @ step
        poses.append(at)
    return np.stack(poses, axis=1)


def wrong_among(robot: sn.Robot, scene: sn.Scene, values: Floats) -> str:
    """Say what is wrong with joint values (m, v) of a robot without segments: limits, an obstacle, a link; or nothing.

    Links may touch those next to them, and those that a joint names.
    """
    low, high = np.array([joint.limits for joint in moving(robot.joints)]).T
    if (values < low - ROUNDING).any() or (values > high + ROUNDING).any():
        return "limits"
    bodies = link_places(robot, values)
    distance = distances_to(scene.obstacles) if len(scene) else []
    for _, points, radius in bodies:
        for measure in distance:
            if measure(points.reshape(-1, 3)).min() < radius - ROUNDING:
                return "overlap"
    names = {joint.name or f"j{i}": i for i, joint in enumerate(robot.joints, 1)}
    for (one, first, r), (other, second, s) in combinations(bodies, 2):
        pair = {names.get(name) for name in (*_touches(robot, one), *_touches(robot, other))}
        if abs(one - other) <= 1 or {one, other} & pair:
            continue
        apart = np.linalg.norm(first[:, :, None] - second[:, None], axis=-1).min()
        if apart < r + s - ROUNDING:
            return "overlap with itself"
    return ""


def _touches(robot: sn.Robot, link: int) -> tuple[str, ...]:
    return moving(robot.joints)[link - 1].touches if link else ()


def link_places(robot: sn.Robot, values: Floats) -> list[tuple[int, Floats, float]]:
    """Places (m, k, 3) along all capsules, with the number of their link (0: the base) and their radius."""
    poses, found, link = link_poses(robot, values), [], 0
    shares = np.linspace(0.0, 1.0, PLACES)[:, None]
    for i, joint in enumerate(robot.joints):
        link += not isinstance(joint, Fixed)
        for start, end, radius in joint.body:
            own = (1.0 - shares) * start + shares * end
            points = np.einsum("mij,kj->mki", poses[:, i, :3, :3], own) + poses[:, i, None, :3, 3]
            found.append((link, points, radius))
    return found


def values_of(robot: sn.Robot, q: Floats) -> Floats:
    """Values (m, v) of the joints of configurations (m, n, 3)."""
    rigid = robot._rigid
    return np.asarray(q[:, rigid.values, rigid.columns] - rigid.shifts)


def tip_of(robot: sn.Robot, values: Floats) -> Floats:
    """Poses (m, 4, 4) of the last link."""
    return link_poses(robot, values)[:, -1] @ robot.tool if math.prod(values.shape) else np.empty((0, 4, 4))
