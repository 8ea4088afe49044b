"""Are joints and the links behind them where a motion may have them? By rotations about axes, without the kernels."""

from itertools import combinations

import numpy as np
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.judges.clearances import distances_among
from benchmarks.judges.kinematics import arc_ends, arc_poses
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


def wrong_among(robot: sn.Robot, scene: sn.Scene, q: Floats) -> str:
    """Say what is wrong with configurations (m, n, 3): limits of joints, an obstacle, a link; or nothing.

    Links may touch those next to them, across links without a body, and those that a joint names; the first segment may
    touch the last link. What segments do to each other is not looked at.
    """
    low, high = np.array([joint.limits for joint in moving(robot.joints)]).T
    values = values_of(robot, q)
    if (values < low - ROUNDING).any() or (values > high + ROUNDING).any():
        return "limits"
    bodies, segments = body_places(robot, q), len(moving(robot.joints)) + 1
    distance = distances_among(scene)
    for _, points, radius in bodies:
        for measure in distance:
            if measure(points.reshape(-1, 3)).min() < radius - ROUNDING:
                return "overlap"
    names = {joint.name or f"j{i}": i for i, joint in enumerate(robot.joints, 1)}
    order = {link: i for i, link in enumerate(sorted({link for link, _, _ in bodies}))}
    for (one, first, r), (other, second, s) in combinations(bodies, 2):
        pair = {names.get(name) for name in (*_touches(robot, one), *_touches(robot, other))}
        if abs(order[one] - order[other]) <= 1 or {one, other} & pair or min(one, other) >= segments:
            continue
        apart = np.linalg.norm(first[:, :, None] - second[:, None], axis=-1).min()
        if apart < r + s - ROUNDING:
            return "overlap with itself"
    return ""


def _touches(robot: sn.Robot, link: int) -> tuple[str, ...]:
    own = moving(robot.joints)
    return own[link - 1].touches if 0 < link <= len(own) else ()


def body_places(robot: sn.Robot, q: Floats) -> list[tuple[int, Floats, float]]:
    """Places (m, k, 3) along all capsules and segments, with the number of their link (0: the base) and their radius.

    The first segment has the number after the last link, all others the next.
    """
    poses, found, link = link_poses(robot, values_of(robot, q)), [], 0
    shares = np.linspace(0.0, 1.0, PLACES)[:, None]
    for i, joint in enumerate(robot.joints):
        link += not isinstance(joint, Fixed)
        for start, end, radius in joint.body:
            own = (1.0 - shares) * start + shares * end
            points = np.einsum("mij,kj->mki", poses[:, i, :3, :3], own) + poses[:, i, None, :3, 3]
            found.append((link, points, radius))
    at = poses[:, -1]
    for k, segment in enumerate(robot.segments):
        own = shares[:, 0, None, None] * q[:, len(q[0]) - len(robot.segments) + k]
        ends = at[:, :3, 3] + np.einsum("mij,kmj->kmi", at[:, :3, :3], arc_ends(*np.moveaxis(own, -1, 0)))
        found.append((link + 1 + (k > 0), np.moveaxis(ends, 0, 1), segment.radius))
        at = at @ arc_poses(*q[:, len(q[0]) - len(robot.segments) + k].T)
    return found


def values_of(robot: sn.Robot, q: Floats) -> Floats:
    """Values (m, v) of the joints of configurations (m, n, 3)."""
    rigid = robot._rigid
    return np.asarray(q[:, rigid.values, rigid.columns] - rigid.shifts)


def tip_of(robot: sn.Robot, q: Floats) -> Floats:
    """Poses (m, 4, 4) of the tool in configurations (m, n, 3)."""
    at = link_poses(robot, values_of(robot, q))[:, -1]
    for arc in np.moveaxis(q[:, len(q[0]) - len(robot.segments) :], 1, 0):
        at = at @ arc_poses(*arc.T)
    return np.asarray(at @ robot.tool)
