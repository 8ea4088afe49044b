"""The residual of the targets, its linearisation, and the best configuration within the limits near a given one.

Plain NumPy. Where a search gave up, the descent says where the residual is least.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.limits import OF_ONE_SEGMENT, Limit, least_distance
from sinuous.model.robot import Robot
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


MOST_STEPS = 100
"""Most Gauss-Newton steps, accepted or refused."""

GAIN = 1e-8
"""Share of the squared residual by which a step has to lower it, or the search ends."""

FIRST_DAMPING = 1e-3
"""Damping of the first step, relative to the squared residual; ten times as much after a step that was refused."""

LEAST_MERIT = 1e-9
"""Squared residual below which the damping shrinks no more."""

DESCENT_ROUNDING = 1e-13
"""Least damping, relative to the square of the derivatives: without any, steps could be of any size."""

MOST_COORDINATES = 600
"""Coordinates (3 n) of the largest robot for which this is done."""

STEP_SECONDS = 1e-3
"""About how long the first step takes."""


def descend_within_limits(problem: Problem, q: Floats, left: Callable[[], float] = lambda: math.inf) -> Floats:
    """Return a configuration (n, 3) within the limits, near `q`, where the targets are missed by as little as possible.

    Obstacles are not looked at. `left` says how many seconds there are: a step is begun where it should end in time.
    """
    robot, count = problem.robot, len(problem.robot)
    long = STEP_SECONDS
    if q.size > MOST_COORDINATES or left() < long:
        return q
    unit = robot.mean_length / count
    scale = np.array([1.0, 1.0, unit])
    residual, limits, damping = residual_of(problem, q), list(robot.limit_set.sides(q)), FIRST_DAMPING
    for _ in range(MOST_STEPS):
        before = left()
        if before < long:
            break
        merit = float(residual.value @ residual.value)
        normals = (np.array([limit.gradient for limit in limits]) * scale).reshape(-1, q.size)
        slacks = np.maximum(0.0, [limit.slack for limit in limits])
        step = _bounded_step(
            residual.jacobian * np.tile(scale, count),
            residual.value,
            damping * max(merit, LEAST_MERIT),
            normals,
            slacks,
        )
        tried = _within(robot, q, limits, q + step.reshape(-1, 3) * scale)
        found = residual_of(problem, tried)
        gained = merit - float(found.value @ found.value)
        long = max(long, before - left()) if before < math.inf else long
        if gained > 0.0:
            q, residual, limits, damping = tried, found, list(robot.limit_set.sides(tried)), 0.1 * damping
            if gained < GAIN * merit:
                break
        else:
            damping *= 10.0
    return q


def _bounded_step(rows: Floats, residual: Floats, damping: float, normals: Floats, slacks: Floats) -> Floats:
    """The step x (3 n,) with least `|rows x - residual|^2 + damping |x|^2` of those with `normals x <= slacks`."""
    turned, sizes, axes = np.linalg.svd(rows, full_matrices=False)
    squares = sizes * sizes
    damping += DESCENT_ROUNDING * squares.sum()

    def shrunk(x: Floats) -> Floats:
        """Return columns x (3 n, k) divided by the square root of `rows^T rows + damping`."""
        along = axes @ x
        return (x - axes.T @ along) / np.sqrt(damping) + axes.T @ (along / np.sqrt(squares + damping)[:, None])

    free = axes.T @ (sizes / np.sqrt(squares + damping) * (turned.T @ residual))
    across = shrunk(normals.T)
    nearest = least_distance(np.empty((0, 0)), free, -across.T, -slacks)
    return shrunk((free if nearest is None else nearest[0])[:, None])[:, 0]


def _within(robot: Robot, before: Floats, limits: list[Limit], after: Floats) -> Floats:
    """Bring the end of a step within the limits: those of one segment one by one, the rest by shortening the step."""
    q = robot.drive.coordinates.project(after)
    share = 1.0
    coupled = [limit for limit in limits if limit.constraint not in OF_ONE_SEGMENT]
    now = robot.limit_set.sides(q) if coupled else ()
    for limit, was in zip((each for each in now if each.constraint not in OF_ONE_SEGMENT), coupled, strict=True):
        if limit.slack < 0.0 < was.slack - limit.slack:
            share = min(share, max(0.0, was.slack) / (was.slack - limit.slack))
    return before + share * (q - before)
