"""The kinematics once more, in plain NumPy and SciPy: what the judges compute with, so never by way of the kernels.

And bodies as thick as a robot demands: what has to be free of obstacles, and what of the body itself.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sinuous.base.arguments import OneEach
from sinuous.base.checks import Floats
from sinuous.model.joints import Fixed, Joint, Prismatic
from sinuous.model.robot import Robot

Indices = NDArray[np.signedinteger]

Bodies = list[tuple[int, Floats, float]]
"""Of capsules and segments the number of their link (0: the base), places (m, k, 3) along them, and their radius. The
first segment has the number after the last link, all others the next."""


def arc_poses(bend_x: Floats, bend_y: Floats, length: Floats) -> Floats:
    """Poses (..., 4, 4) of the ends of arcs in the frames of their beginnings.

    The chord is `length * sinc(bend / 2)` long and turned by half the bend, which needs no series near straight.
    """
    poses = np.zeros((*np.shape(bend_x), 4, 4))
    turns = np.stack([-bend_y, bend_x, np.zeros_like(bend_x)], axis=-1)
    poses[..., :3, :3] = Rotation.from_rotvec(turns.reshape(-1, 3)).as_matrix().reshape(*turns.shape[:-1], 3, 3)
    poses[..., :3, 3] = arc_ends(bend_x, bend_y, length)
    poses[..., 3, 3] = 1.0
    return poses


def arc_ends(bend_x: Floats, bend_y: Floats, length: Floats) -> Floats:
    """Positions (..., 3) of these poses alone."""
    half = 0.5 * np.hypot(bend_x, bend_y)
    lean = np.sinc(half / np.pi)
    aside = 0.5 * length * lean * lean
    return np.stack([aside * bend_x, aside * bend_y, length * lean * np.cos(half)], axis=-1)


def moving(joints: tuple[Joint, ...]) -> list[Joint]:
    """Return the joints that have a value."""
    return [joint for joint in joints if not isinstance(joint, Fixed)]


def link_poses(robot: Robot, values: Floats) -> Floats:
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


def arm_of(robot: Robot) -> Robot | None:
    """Return the segments as a robot of their own; none where there are joints alone."""
    return Robot(robot.segments, self_clearance=robot.self_clearance) if robot.segments else None


def segment_ends(robot: Robot, q: Floats) -> Floats:
    """Poses (m, n + 1, 4, 4) of where the segments begin and of the ends of all, of configurations (m, rows, 3)."""
    values, arcs = robot.split(q) if robot.joints else (q, q)
    steps = arc_poses(arcs[..., 0], arcs[..., 1], arcs[..., 2])
    poses = np.empty((len(q), arcs.shape[1] + 1, 4, 4))
    poses[:, 0] = link_poses(robot, values)[:, -1] if robot.joints else robot.base
    for k in range(arcs.shape[1]):
        poses[:, k + 1] = poses[:, k] @ steps[:, k]
    return poses


class Backbones(NamedTuple):
    """Segments of m configurations, which places and tangents on them are asked of.

    Attributes
    ----------
    q : ndarray (m, n, 3)
    starts : ndarray (m, n + 1, 4, 4)
        Poses of where they begin.
    before : ndarray (m, n)
        How far along the backbone that is.
    """

    q: Floats
    starts: Floats
    before: Floats

    @classmethod
    def of(cls, robot: Robot, q: Floats) -> "Backbones":
        """Prepare configurations (m, n, 3) of a robot without joints."""
        return cls(q, segment_ends(robot, q), np.cumsum(q[..., 2], axis=1) - q[..., 2])

    def places(self, shape: Indices, segment: Indices, fraction: Floats) -> Floats:
        """Points (k, 3), by configuration, segment, and share of that."""
        parts, start = self.q[shape, segment] * fraction[:, None], self.starts[shape, segment]
        local = arc_ends(parts[:, 0], parts[:, 1], parts[:, 2])
        return np.asarray(np.einsum("kij,kj->ki", start[:, :3, :3], local) + start[:, :3, 3])

    def tangents(self, shape: Indices, segment: Indices, fraction: Floats) -> Floats:
        """Unit tangents (k, 3) there."""
        bends = self.q[shape, segment, :2] * fraction[:, None]
        angle = np.hypot(bends[:, 0], bends[:, 1])
        local = np.concatenate([bends * np.sinc(angle / np.pi)[:, None], np.cos(angle)[:, None]], axis=-1)
        return np.asarray(np.einsum("kij,kj->ki", self.starts[shape, segment, :3, :3], local))


def body_places(robot: Robot, q: Floats, places: int) -> Bodies:
    """Return places along all capsules of links, and segments, of an arm with joints in configurations (m, rows, 3)."""
    values, arcs = robot.split(q)
    poses, found, link = link_poses(robot, values), [], 0
    shares, starts = np.linspace(0.0, 1.0, places)[:, None], segment_ends(robot, q)
    for i, joint in enumerate(robot.joints):
        link += not isinstance(joint, Fixed)
        for start, end, radius in joint.body:
            own = (1.0 - shares) * start + shares * end
            points = np.einsum("mij,kj->mki", poses[:, i, :3, :3], own) + poses[:, i, None, :3, 3]
            found.append((link, points, radius))
    for k, segment in enumerate(robot.segments):
        own, at = shares * arcs[:, k, None], starts[:, k]
        ends = arc_ends(own[..., 0], own[..., 1], own[..., 2]) @ np.swapaxes(at[:, :3, :3], 1, 2) + at[:, None, :3, 3]
        found.append((link + 1 + (k > 0), ends, segment.radius))
    return found


def tip_poses(robot: Robot, q: Floats) -> Floats:
    """Poses (m, 4, 4) of the tool in the world."""
    tips: Floats = segment_ends(robot, q)[:, -1] @ robot.tool
    return tips


def body_points(robot: Robot, q: Floats, samples: int) -> tuple[Floats, Floats]:
    """Points of the backbone, and how far along it they lie.

    Parameters
    ----------
    robot : Robot
    q : ndarray (m, n, 3)
    samples : int
        Intervals a segment; both ends of every segment are among the points.

    Returns
    -------
    points : ndarray (m, n, samples + 1, 3)
    along : ndarray (m, n, samples + 1)
        Arc length from the base.
    """
    fractions = np.linspace(0.0, 1.0, samples + 1)
    parts = q[..., None, :] * fractions[:, None]
    local = arc_ends(parts[..., 0], parts[..., 1], parts[..., 2])
    starts = segment_ends(robot, q)[:, :-1]
    points = local @ np.swapaxes(starts[..., :3, :3], -1, -2) + starts[..., None, :3, 3]
    before = np.cumsum(q[..., 2], axis=1) - q[..., 2]
    return points, before[..., None] + parts[..., 2]


def bend_caps(robot: Robot, lengths: Floats) -> Floats:
    """Largest bends (..., n) that the limits leave to segments of lengths (..., n)."""
    caps = np.broadcast_to([segment.max_bend for segment in robot.segments], lengths.shape).copy()
    for k, segment in enumerate(robot.segments):
        if np.isfinite(segment.max_curvature):  # else length 0 would leave no bend
            caps[..., k] = np.minimum(caps[..., k], segment.max_curvature * lengths[..., k])
    return caps


def measured_body(robot: Robot) -> Robot:
    """Return the body that reported clearances are measured from: thicker by the uncertainty."""
    return robot if robot.uncertainty is None else thicker(robot, robot.uncertainty.bound)


def needed_body(robot: Robot) -> Robot:
    """Return the body that has to be free of obstacles: thicker by the uncertainty and the demanded clearance."""
    return thicker(measured_body(robot), robot.clearance) if np.any(robot.clearance) else measured_body(robot)


def self_body(robot: Robot) -> Robot:
    """Return the body that has to be free of itself: thicker by half of the demanded clearance from itself."""
    return thicker(robot, 0.5 * np.array(robot.self_clearance)) if np.any(robot.self_clearance) else robot


def thicker(robot: Robot, by: OneEach) -> Robot:
    """Return the robot with other radii, and without any demand."""
    own = np.broadcast_to(np.asarray(by, np.float64), len(robot)).tolist()
    segments = [each.changed(radius=each.radius + more) for each, more in zip(robot.segments, own, strict=True)]
    return robot.changed(segments=segments, clearance=0.0, self_clearance=0.0, uncertainty=None)
