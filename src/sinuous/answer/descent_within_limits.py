"""The best configuration within the limits near one where a search gave up: the residual of the targets is least there.

A search gives up a start that gains little, so it may stop short of the place where limits balance the targets. A few
damped Gauss-Newton steps go on from there. Each solves a small problem with all limits as linear inequalities:
least-distance programming.
"""

import math
from collections.abc import Callable

import numpy as np

from sinuous.answer.residual import residual_of
from sinuous.base.checks import Floats
from sinuous.model.least_distance import least_distance
from sinuous.model.limits import Limit
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem

MOST_STEPS = 100
"""Most Gauss-Newton steps, accepted or refused."""

GAIN = 1e-8
"""Share of the squared residual by which a step has to lower it, or the search ends."""

FIRST_DAMPING = 1e-3
"""Damping of the first step, relative to the squared residual; ten times as much after a step that was refused."""

LEAST_MERIT = 1e-9
"""Squared residual below which the damping shrinks no more."""

ROUNDING = 1e-13
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
    damping += ROUNDING * squares.sum()

    def shrunk(x: Floats) -> Floats:
        """Return columns x (3 n, k) divided by the square root of `rows^T rows + damping`."""
        along = axes @ x
        return (x - axes.T @ along) / np.sqrt(damping) + axes.T @ (along / np.sqrt(squares + damping)[:, None])

    free = axes.T @ (sizes / np.sqrt(squares + damping) * (turned.T @ residual))
    across = shrunk(normals.T)
    nearest = least_distance(np.empty((0, 0)), free, -across.T, -slacks)
    return shrunk((free if nearest is None else nearest[0])[:, None])[:, 0]


def _within(robot: Robot, before: Floats, limits: list[Limit], after: Floats) -> Floats:
    """Bring the end of a step within the limits: lengths and bends one by one, the rest by shortening the step."""
    q = robot.drive.coordinates.project(after)
    share = 1.0
    lines = [limit for limit in limits if limit.constraint == "actuator"]
    now = robot.limit_set.sides(q) if lines else ()
    for limit, was in zip((each for each in now if each.constraint == "actuator"), lines, strict=True):
        if limit.slack < 0.0 < was.slack - limit.slack:
            share = min(share, max(0.0, was.slack) / (was.slack - limit.slack))
    return before + share * (q - before)
