"""Every solution of a full pose for three segments of fixed length, by a dense scan in plain NumPy.

The rotation of a segment has no part about its own z axis: as unit quaternions (w, x, y, 0), those of bends to 2 pi are
a sphere, and those of bends to pi half of it. Take that of the last segment from a grid. Then `first * second` is
known, and that the second has no part about z is one linear equation for the first, which leaves a circle. So a grid of
three dimensions meets the rotation everywhere; the position is met by Newton's method from all of its points.
"""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.judges.kinematics import body_points, tip_poses
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot

RINGS, TURNS = 8, 16
"""Points of the grid from the middle of a half sphere to its edge, and round it; twice as many go round a circle."""

NEAR = 1.0
"""Largest distance from the target, of the mean length of a segment, from which Newton's method is tried."""

ITERATIONS = 30

LONGEST = 0.7
"""Longest step of Newton's method, in rad."""

MET = 1e-9
"""Error (of the robot's mean length, and rad) with which a solution counts as met."""


def all_solutions(robot: Robot, pose: Floats, apart: float) -> list[Floats]:
    """Return all configurations (3, 3) within limits that bring the tip to a pose (4, 4).

    Two are the same when no point of their backbones is farther from its counterpart than `apart`.
    """
    q = _starts(robot, np.linalg.inv(robot.base) @ pose @ np.linalg.inv(robot.tool))
    near = np.linalg.norm(_errors(robot, q, pose)[:, :3], axis=1) < NEAR / len(robot)
    q = q[near]
    met = np.zeros(len(q), bool)
    for _ in range(ITERATIONS):
        q[~met] = _newton(robot, q[~met], pose)
        met = np.abs(_errors(robot, q, pose)).max(axis=1) < MET
    widest = np.array([segment.max_bend for segment in robot.segments])
    within = (np.hypot(q[..., 0], q[..., 1]) <= widest + MET).all(axis=1)
    return distinct(robot, q[met & within], apart)


def distinct(robot: Robot, q: Floats, apart: float) -> list[Floats]:
    """Return configurations whose backbones differ, the first of every kind."""
    kept: list[Floats] = []
    shapes: list[Floats] = []
    for one in q:
        shape = body_points(robot, one[None], 8)[0].reshape(-1, 3)
        if all(np.linalg.norm(shape - other, axis=1).max() > apart for other in shapes):
            kept.append(one)
            shapes.append(shape)
    return kept


def _errors(robot: Robot, q: Floats, pose: Floats) -> Floats:
    """Errors (m, 6) of tips: position, of the robot's mean length, and rotation (rad)."""
    tips = tip_poses(robot, q)
    turn = Rotation.from_matrix(tips[:, :3, :3] @ pose[:3, :3].T).as_rotvec()
    return np.concatenate([(tips[:, :3, 3] - pose[:3, 3]) / robot.mean_length, turn], axis=1)


def _newton(robot: Robot, q: Floats, pose: Floats) -> Floats:
    """One step of Newton's method for all bends (m, 6), with differences for derivatives."""
    small = 1e-6
    bends = [(k, axis) for k in range(len(robot)) for axis in range(2)]
    columns = []
    for k, axis in bends:
        aside = np.zeros_like(q)
        aside[:, k, axis] = small
        columns.append((_errors(robot, q + aside, pose) - _errors(robot, q - aside, pose)) / (2.0 * small))
    step = np.einsum("mij,mj->mi", np.linalg.pinv(np.stack(columns, axis=-1), rcond=1e-9), _errors(robot, q, pose))
    step *= np.minimum(1.0, LONGEST / np.maximum(np.linalg.norm(step, axis=1), 1e-300))[:, None]
    moved = q.copy()
    moved[..., :2] -= step.reshape(-1, len(robot), 2)
    return moved


def _starts(robot: Robot, pose: Floats) -> Floats:
    """Configurations (m, 3, 3) whose rotations multiply to that of a pose (4, 4) in the frame of the base."""
    widest = np.minimum([segment.max_bend for segment in robot.segments], 2.0 * math.pi)
    rings = math.ceil(RINGS * widest[2] / math.pi)
    half, turn = np.meshgrid(
        (np.arange(rings) + 0.5) / rings * 0.5 * widest[2], (np.arange(TURNS) + 0.5) / TURNS * 2.0 * math.pi
    )
    last = _quaternions(half.ravel(), turn.ravel())
    both = _times(np.roll(Rotation.from_matrix(pose[:3, :3]).as_quat(), 1), _inverse(last))
    # What is left for the second, first^-1 both, has the part w z' - x y' + y x' about z.
    normal = both[:, [3, 2, 1]] * [1.0, -1.0, 1.0]
    across = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)])
    across /= np.linalg.norm(across, axis=1)[:, None]
    other = np.cross(normal / np.linalg.norm(normal, axis=1)[:, None], across)
    on = (np.arange(2 * TURNS) + 0.5) / TURNS * math.pi
    circles = np.cos(on)[:, None] * across[:, None] + np.sin(on)[:, None] * other[:, None]
    first = np.concatenate([circles.reshape(-1, 3), np.zeros((circles[..., 0].size, 1))], axis=1)
    second = _times(_inverse(first), np.repeat(both, len(on), axis=0))
    first, last = np.tile(first, (2, 1)), np.tile(np.repeat(last, len(on), axis=0), (2, 1))
    second = np.concatenate([second, -second])  # the same rotation, by the other bend
    lengths = np.array([segment.length[0] for segment in robot.segments])
    bends = np.stack([_bends(first), _bends(second), _bends(last)], axis=1)
    q = np.concatenate([bends, np.broadcast_to(lengths[:, None], (*bends.shape[:2], 1))], axis=-1)
    return np.asarray(q[(np.linalg.norm(bends, axis=-1) <= widest).all(axis=1)])


def _quaternions(half: Floats, turn: Floats) -> Floats:
    """Unit quaternions (m, 4) of segments that bend by twice `half` towards the angle `turn`."""
    return np.stack(
        [np.cos(half), -np.sin(half) * np.sin(turn), np.sin(half) * np.cos(turn), np.zeros_like(half)], axis=-1
    )


def _bends(quaternions: Floats) -> Floats:
    """Bends (m, 2) of such quaternions, up to a full turn."""
    sine = np.linalg.norm(quaternions[:, 1:3], axis=1)
    angle = 2.0 * np.arctan2(sine, quaternions[:, 0])
    axes = np.stack([quaternions[:, 2], -quaternions[:, 1]], axis=1)
    return np.asarray(axes * (angle / np.maximum(sine, 1e-12))[:, None])


def _times(a: Floats, b: Floats) -> Floats:
    """Products of quaternions (..., 4)."""
    w1, x1, y1, z1 = np.moveaxis(np.asarray(a), -1, 0)
    w2, x2, y2, z2 = np.moveaxis(np.asarray(b), -1, 0)
    return np.stack(
        [
            w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
            w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
            w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
            w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
        ],
        axis=-1,
    )


def _inverse(a: Floats) -> Floats:
    return np.asarray(a * np.array([1.0, -1.0, -1.0, -1.0]))
