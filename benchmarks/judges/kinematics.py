"""The kinematics once more, in plain NumPy and SciPy: what the judges compute with, so never by way of the kernels."""

import numpy as np
from scipy.spatial.transform import Rotation

from sinuous.base.checks import Floats
from sinuous.model.robot import Robot


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


def segment_ends(robot: Robot, q: Floats) -> Floats:
    """Poses (m, n + 1, 4, 4) in the world of the base and of the ends of all segments, of configurations (m, n, 3)."""
    steps = arc_poses(q[..., 0], q[..., 1], q[..., 2])
    poses = np.empty((len(q), len(robot) + 1, 4, 4))
    poses[:, 0] = robot.base
    for k in range(len(robot)):
        poses[:, k + 1] = poses[:, k] @ steps[:, k]
    return poses


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


def twist_norm(have: Floats, want: Floats) -> Floats:
    """Norms (...) of the twists that take poses `have` (..., 4, 4) to poses `want`, in the frame of `have`.

    The twist is the logarithm in se(3): rotation (rad) and translation (length) together, as the literature on three
    segments of length 1 measures its errors.
    """
    back = np.swapaxes(have[..., :3, :3], -1, -2)
    turn = back @ want[..., :3, :3]
    shift = np.einsum("...ij,...j->...i", back, want[..., :3, 3] - have[..., :3, 3])
    omega = Rotation.from_matrix(turn.reshape(-1, 3, 3)).as_rotvec().reshape(shift.shape)
    angle = np.linalg.norm(omega, axis=-1)
    safe = np.maximum(angle, 1e-4)  # below, the factor is 1 / 12 to eight digits
    factor = (1.0 - 0.5 * safe / np.tan(0.5 * safe)) / safe**2
    once = np.cross(omega, shift)
    move = shift - 0.5 * once + factor[..., None] * np.cross(omega, once)
    norms: Floats = np.sqrt(angle**2 + (move**2).sum(axis=-1))
    return norms


def bend_caps(robot: Robot, lengths: Floats) -> Floats:
    """Largest bends (..., n) that the limits leave to segments of lengths (..., n)."""
    caps = np.broadcast_to([segment.max_bend for segment in robot.segments], lengths.shape).copy()
    for k, segment in enumerate(robot.segments):
        if np.isfinite(segment.max_curvature):  # else length 0 would leave no bend
            caps[..., k] = np.minimum(caps[..., k], segment.max_curvature * lengths[..., k])
    return caps
