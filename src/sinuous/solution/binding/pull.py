"""How the targets pull at a configuration: their residual and its linearisation, in plain NumPy."""

from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.solution.turns import turn_between


class Pull(NamedTuple):
    """The residual of all targets: lengths relative to the robot's mean length, angles in rad.

    Attributes
    ----------
    rows : ndarray (m, 3 n)
        Its derivatives by bends (rad) and lengths (length unit), but for the sign.
    misses : ndarray (m,)
        What is missing.
    met : bool
        Whether all targets are within tolerance.
    off : float
        Largest distance to a target position, in the length unit.
    """

    rows: Floats
    misses: Floats
    met: bool
    off: float


def pull_of(problem: Problem, q: Floats) -> Pull:
    """Linearise the targets at the configuration `q` (n, 3)."""
    robot, tolerance = problem.robot, problem.tolerance
    poses, unit = robot.forward(q), robot.mean_length
    rows, misses, met, off = [], [], True, 0.0
    for target in problem.targets:
        last = len(robot) if target.segment is None else target.segment
        jacobian = robot.jacobian(q, last)
        pose = poses[-1] @ robot.tool if last == len(robot) else poses[last - 1]
        if target.position is not None:
            away = target.position - pose[:3, 3]
            rows.append(jacobian[3:] / unit)
            misses.append(away / unit)
            off = max(off, float(np.linalg.norm(away)))
        turn, across = _turn(target, pose[:3, :3])
        if across is not None:
            rows.append(across @ jacobian[:3])
            misses.append(turn)
            met &= bool(np.linalg.norm(turn) <= tolerance.angle * (1.0 + 1e-9))
    met &= off <= (tolerance.position or 0.0) * (1.0 + 1e-9)
    return Pull(np.concatenate(rows), np.concatenate(misses), met, off)


def _turn(target: Target, rotation: Floats) -> tuple[Floats, Floats | None]:
    """The rotation vector that is missing, and what it counts of a rotation (3, 3): all, or what turns the tangent."""
    if target.rotation is not None:
        return turn_between(rotation, target.rotation), np.eye(3)
    if target.direction is None:
        return np.zeros(3), None
    tangent = rotation[:, 2]
    return turn_between(tangent, target.direction), np.eye(3) - np.outer(tangent, tangent)
