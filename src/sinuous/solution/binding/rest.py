"""The configuration where the pull of the targets and the limits come to rest, near one where a search gave up.

A search gives a start up that gains little, and so short of the place where limits balance the targets. A few
Gauss-Newton steps go on from there, each the solution of a small problem with all limits as linear inequalities:
least-distance programming (Lawson & Hanson 1974, chapter 23), by nonnegative least squares.
"""

import numpy as np

from sinuous.checks import Floats
from sinuous.problem.problem import Problem
from sinuous.robot.robot import Robot
from sinuous.solution.binding.limits import Limit, limits_of, normal
from sinuous.solution.binding.nonnegative import nonnegative_least_squares
from sinuous.solution.binding.pull import pull_of

STEPS = 30
"""Most steps, taken or refused."""

GAIN = 1e-8
"""Share of the residual that a step has to gain."""

ROUNDING = 1e-13
"""Damping, relative to the square of the derivatives, below which rounding could make their factors imaginary."""

MOST = 600
"""Coordinates of the largest robot for which this is done; the cost grows with their cube."""


def at_rest(problem: Problem, q: Floats) -> Floats:
    """Return a configuration (n, 3) within the limits, near `q`, where the targets are missed by as little as possible.

    Obstacles are not looked at.
    """
    robot, count = problem.robot, len(problem.robot)
    if q.size > MOST:
        return q
    unit = robot.mean_length / count
    scale = np.array([1.0, 1.0, unit])
    pull, limits, damping = pull_of(problem, q), list(limits_of(robot, q)), 1e-3
    for _ in range(STEPS):
        merit = float(pull.misses @ pull.misses)
        normals = np.array([normal(limit, unit) for limit in limits])
        slacks = np.maximum(0.0, [limit.slack for limit in limits])
        motion = _least(pull.rows * np.tile(scale, count), pull.misses, damping * max(merit, 1e-9), normals, slacks)
        tried = _within(robot, q, limits, q + motion.reshape(-1, 3) * scale)
        found = pull_of(problem, tried)
        gained = merit - float(found.misses @ found.misses)
        if gained > 0.0:
            q, pull, limits, damping = tried, found, list(limits_of(robot, tried)), 0.1 * damping
            if gained < GAIN * merit:
                break
        else:
            damping *= 10.0
    return q


def _least(rows: Floats, misses: Floats, damping: float, normals: Floats, slacks: Floats) -> Floats:
    """The motion x (3 n,) with least `|rows x - misses|^2 + damping |x|^2` of those with `normals x <= slacks`."""
    square = rows.T @ rows
    root = np.linalg.cholesky(square + (damping + ROUNDING * np.trace(square)) * np.eye(len(square)))
    free = np.linalg.solve(root, rows.T @ misses)
    across = np.linalg.solve(root, normals.T).T
    system = np.vstack([-across.T, across @ free - slacks])
    wanted = np.zeros(len(system))
    wanted[-1] = 1.0
    left = system @ nonnegative_least_squares(system, wanted) - wanted
    shift = -left[:-1] / left[-1] if left[-1] != 0.0 else np.zeros_like(free)
    motion: Floats = np.linalg.solve(root.T, free + shift)
    return motion


def _within(robot: Robot, before: Floats, limits: list[Limit], after: Floats) -> Floats:
    """Bring the end of a step within the limits: lengths and bends one by one, the rest by shortening the step."""
    q = after.copy()
    low, high = np.array([segment.length for segment in robot.segments]).T
    q[:, 2] = np.clip(q[:, 2], low, high)
    bends = np.array([s.max_bend if s.length[1] > 0.0 else 0.0 for s in robot.segments])
    curvatures = np.array(robot.curvatures)
    curved = np.isfinite(curvatures)
    most = np.where(curved, np.minimum(bends, np.where(curved, curvatures, 0.0) * q[:, 2]), bends)
    size = np.hypot(q[:, 0], q[:, 1])
    q[:, :2] *= np.where(size > most, most / np.maximum(size, 1e-300), 1.0)[:, None]
    share = 1.0
    lines = [limit for limit in limits if limit.constraint == "actuator"]
    now = limits_of(robot, q) if lines else ()
    for limit, was in zip((each for each in now if each.constraint == "actuator"), lines, strict=True):
        if limit.slack < 0.0 < was.slack - limit.slack:
            share = min(share, max(0.0, was.slack) / (was.slack - limit.slack))
    result: Floats = before + share * (q - before)
    return result
