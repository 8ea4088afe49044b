"""Are joints, the links behind them and segments where they may be? By rotations about axes, without the kernels."""

import math
from itertools import combinations, pairwise

import numpy as np
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.judges.clearances import distances_among
from benchmarks.judges.judge import Flags, within_limits
from benchmarks.judges.kinematics import arc_ends, arc_poses
from benchmarks.judges.self_collision import look
from sinuous.base.checks import Floats
from sinuous.model.joints import Fixed, Joint, Prismatic

PLACES = 25
"""Places along a capsule or a segment where it is looked at."""

ROUNDING = 1e-9
"""By how much limits and clearances may be missed, in rad and in lengths of the robot."""

Bodies = list[tuple[int, Floats, float]]
"""Of capsules and segments the number of their link (0: the base), places (m, k, 3) along them, and their radius. The
first segment has the number after the last link, all others the next."""


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


def arm_of(robot: sn.Robot) -> sn.Robot | None:
    """Return the segments as a robot of their own; none where there are joints alone."""
    return sn.Robot(robot.segments, self_clearance=robot.self_clearance) if robot.segments else None


def wrong_among(robot: sn.Robot, scene: sn.Scene, q: Floats) -> str:
    """Say what is wrong with configurations (m, n, 3): limits, an obstacle, the body itself; or nothing."""
    slack = ROUNDING * max(1.0, robot.mean_length)
    if not keep_limits(robot, q).all():
        return "limits"
    if len(scene) and clearances(robot, scene, q).min() < -slack:
        return "overlap"
    return "overlap with itself" if gaps(robot, q).min() < -slack else ""


def keep_limits(robot: sn.Robot, q: Floats) -> Flags:
    """Say of configurations (m, n, 3) whether joints and segments keep their limits."""
    values, own = robot.split(q)
    low, high = np.array([joint.limits for joint in moving(robot.joints)]).T
    good = ((values >= low - ROUNDING * (1.0 + abs(low))) & (values <= high + ROUNDING * (1.0 + abs(high)))).all(axis=1)
    arm = arm_of(robot)
    return np.asarray(good if arm is None else good & within_limits(arm, own))


def clearances(robot: sn.Robot, scene: sn.Scene, q: Floats, places: int = PLACES) -> Floats:
    """Return the least clearance (m,) from obstacles that is seen of configurations (m, n, 3): never below the true."""
    least = np.full(len(q), math.inf)
    for measure in distances_among(scene):
        for _, points, radius in body_places(robot, q, places):
            own = measure(points.reshape(-1, 3)).reshape(points.shape[:2])
            least = np.minimum(least, own.min(axis=1) - radius)
    return least


def gaps(robot: sn.Robot, q: Floats, places: int = PLACES, below: float = 0.0) -> Floats:
    """Return the least distance (m,) of the body from itself that is seen of configurations (m, n, 3).

    Of segments from each other only what is less than `below` counts.

    Links may touch those next to them, those next but for links without a body, and those that a joint names; the first
    segment may touch the last link with a body.
    """
    bodies, own = body_places(robot, q, places), moving(robot.joints)
    links, least = len(own), np.full(len(q), math.inf)
    chain = sorted({link for link, _, _ in bodies if link <= links} | {links + 1})
    free = {*pairwise(chain)} | {(i, i + 1) for i in range(links + 1)} | _named(robot)
    for (one, first, r), (other, second, s) in combinations(bodies, 2):
        pair = min(one, other), max(one, other)
        if one == other or pair in free or pair[0] > links:
            continue
        middle = first[:, :1]
        a, b = first - middle, second - middle
        squares = (a * a).sum(-1)[:, :, None] + (b * b).sum(-1)[:, None] - 2.0 * a @ np.swapaxes(b, 1, 2)
        least = np.minimum(least, np.sqrt(squares.min(axis=(1, 2)).clip(0.0)) - r - s)
    arm = arm_of(robot)
    return least if arm is None else np.minimum(least, look(arm, robot.split(q)[1], below).least)


def _named(robot: sn.Robot) -> set[tuple[int, int]]:
    """Pairs of links that joints say may touch, the lower number first."""
    link, number, pairs = 0, {"base": 0}, set[tuple[int, int]]()
    for i, joint in enumerate(robot.joints, 1):
        link += not isinstance(joint, Fixed)
        number[joint.name or f"j{i}"] = link
    for i, joint in enumerate(robot.joints, 1):
        own = number[joint.name or f"j{i}"]
        pairs |= {(min(own, number[name]), max(own, number[name])) for name in joint.touches}
    return pairs


def body_places(robot: sn.Robot, q: Floats, places: int = PLACES) -> Bodies:
    """Return places along all capsules and segments of configurations (m, n, 3)."""
    values, arcs = robot.split(q)
    poses, found, link = link_poses(robot, values), [], 0
    shares = np.linspace(0.0, 1.0, places)[:, None]
    for i, joint in enumerate(robot.joints):
        link += not isinstance(joint, Fixed)
        for start, end, radius in joint.body:
            own = (1.0 - shares) * start + shares * end
            points = np.einsum("mij,kj->mki", poses[:, i, :3, :3], own) + poses[:, i, None, :3, 3]
            found.append((link, points, radius))
    for k, (segment, at) in enumerate(zip(robot.segments, _ends_of_arcs(poses[:, -1], arcs), strict=False)):
        own = shares[:, 0, None, None] * arcs[:, k]
        ends = at[:, :3, 3] + np.einsum("mij,kmj->kmi", at[:, :3, :3], arc_ends(*np.moveaxis(own, -1, 0)))
        found.append((link + 1 + (k > 0), np.moveaxis(ends, 0, 1), segment.radius))
    return found


def segment_poses(robot: sn.Robot, q: Floats) -> Floats:
    """Poses (m, n + 1, 4, 4) of where the segments begin and the last one ends, of configurations (m, r, 3)."""
    values, arcs = robot.split(q)
    return np.stack(_ends_of_arcs(link_poses(robot, values)[:, -1], arcs), axis=1)


def _ends_of_arcs(begin: Floats, arcs: Floats) -> list[Floats]:
    """Poses (m, 4, 4) of where arcs (m, n, 3) begin, one after the other, and of where the last one ends."""
    poses = [begin]
    for arc in np.moveaxis(arcs, 1, 0):
        poses.append(poses[-1] @ arc_poses(*arc.T))
    return poses


def tip_of(robot: sn.Robot, q: Floats) -> Floats:
    """Poses (m, 4, 4) of the tool in configurations (m, n, 3)."""
    return np.asarray(segment_poses(robot, q)[:, -1] @ robot.tool)
