"""The residual of the targets at a configuration, and its linearisation, in plain NumPy."""

import math
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.problem.problem import Problem, ask_body
from sinuous.problem.target import Target

PARALLEL = 1e-9
"""Sine of the angle below which two directions count as parallel: their common normal cannot be computed."""

ROUNDING = 1e-9
"""By how much rounding may exceed a tolerance, relative to it."""


class Residual(NamedTuple):
    """By how much all targets are missed; lengths are relative to the robot's mean length, angles in rad.

    Attributes
    ----------
    value : ndarray (m,)
        What is missing: target minus end.
    jacobian : ndarray (m, 3 n)
        The derivatives of the ends by bends (rad) and lengths (length unit): those of `value` with the other sign.
    met : bool
        Whether all targets are within tolerance.
    position_error, angle_error : float
        Largest distance (length unit) and angle (rad) to a target.
    """

    value: Floats
    jacobian: Floats
    met: bool
    position_error: float
    angle_error: float


def residual_of(problem: Problem, q: Floats) -> Residual:
    """Linearise the residual at the configuration `q` (n, 3)."""
    robot, tolerance = problem.robot, problem.tolerance
    poses, unit = robot.forward(q), robot.mean_length
    rows, missing, position_error, angle_error = [], [], 0.0, 0.0
    for target in problem.targets:
        last = robot.end_row(target.segment)
        jacobian = robot._row_jacobian(q, last)
        pose = poses[-1] @ robot.tool if last == len(robot) else poses[last - 1]
        if target.position is not None:
            away = target.position - pose[:3, 3]
            rows.append(jacobian[3:] / unit)
            missing.append(away / unit)
            position_error = max(position_error, float(np.linalg.norm(away)))
        turn, turning = _rotation_error(target, pose[:3, :3])
        if turning is not None:
            rows.append(turning @ jacobian[:3])
            missing.append(turn)
            angle_error = max(angle_error, float(np.linalg.norm(turn)))
    most = 1.0 + ROUNDING
    met = position_error <= most * (tolerance.position or 0.0) and angle_error <= most * tolerance.angle
    return Residual(np.concatenate(missing), np.concatenate(rows), met, position_error, angle_error)


def residual_under_load(problem: Problem, q: Floats) -> Residual:
    """The same of the body of arcs that a drive (n, 3) becomes under load; where nothing pulls, of the robot itself."""
    own = ask_body(problem.robot, q, problem.targets)
    return residual_of(Problem(own.body, own.targets, problem.scene, problem.tolerance), own.arcs)


def _rotation_error(target: Target, rotation: Floats) -> tuple[Floats, Floats | None]:
    """The rotation vector (3,) from an orientation (3, 3) to a target's, and what of a rotation counts (3, 3).

    A direction leaves the rotation about it free; `None` where no orientation is asked for.
    """
    if target.rotation is not None:
        return rotation_between(rotation, target.rotation), np.eye(3)
    if target.direction is None:
        return np.zeros(3), None
    tangent = rotation[:, 2]
    return rotation_between(tangent, target.direction), np.eye(3) - np.outer(tangent, tangent)


def _cross(a: float, b: float, c: float, x: float, y: float, z: float) -> Floats:
    """Cross product (3,) of two vectors: NumPy's takes most of its time to find out what it was given."""
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def rotation_between(before: Floats, after: Floats) -> Floats:
    """Return the rotation vector (3,), rad, from a unit vector (3,) or a rotation (3, 3) to another one.

    Of two opposite unit vectors it is a rotation by pi about some normal of them.
    """
    if before.ndim == 2:
        from scipy.spatial.transform import Rotation  # noqa: PLC0415

        return Rotation.from_matrix(after @ before.T).as_rotvec()
    axis, cosine = _cross(*before.tolist(), *after.tolist()), float(before @ after)
    sine = math.sqrt(axis @ axis)
    if sine > PARALLEL:
        return axis * (math.atan2(sine, cosine) / sine)
    if cosine > 0.0:
        return axis
    across = np.cross(before, np.eye(3)[np.abs(before).argmin()])
    return math.pi * across / np.linalg.norm(across)
