"""The configuration within all limits that is nearest to another one.

Limits are linear or convex: those that a configuration violates are cut by their tangents, and the nearest one within
all cuts takes its place, until none is violated (Kelley 1960; Boyle & Dykstra 1986 for other ways to project).
"""

from collections.abc import Iterator

import numpy as np

from sinuous.answer.constraints import limits_of
from sinuous.answer.least_distance import least_distance
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.robot import LIMIT_ROUNDING, Robot

ROUNDS = 100
"""Most times that cuts are added; a few are usual."""

INSET = 0.1
"""How far within a limit a cut lies, as a share of what rounding may exceed it by."""


def clamp(robot: Robot, q: Floats) -> Floats:
    """Return the configuration (n, 3) within all limits that is nearest to `q`; see `Robot.clamp`."""
    slack = INSET * LIMIT_ROUNDING * min(1.0, robot.mean_length)
    scale = np.tile([1.0, 1.0, robot.mean_length / len(robot)], len(robot))
    weights, bounds, x = np.empty((0, q.size)), np.empty(0), q
    for _ in range(ROUNDS):
        if not robot.violations(x):
            return x
        rows, most = zip(*_cuts(robot, x, slack), strict=True)
        weights, bounds = np.concatenate([weights, rows]), np.append(bounds, most)
        found = least_distance(np.empty((0, 0)), q.ravel() / scale, -weights * scale, -bounds)
        if found is None:
            break
        x = (found[0] * scale).reshape(q.shape)
    raise InputError("q", "no configuration within all limits was found near it", q.tolist(), "one nearer to them")


def _cuts(robot: Robot, q: Floats, slack: float) -> Iterator[tuple[Floats, float]]:
    """Yield a row (3 n,) for every limit that a configuration violates, and what its sum must be at most."""
    for limit in limits_of(robot, q):
        if limit.slack < slack:
            normal = limit.gradient.ravel()
            inset = 0.0 if limit.fixed else slack
            yield normal, float(normal @ q.ravel()) + limit.slack - inset
    rows = robot.tension_rows
    if rows is not None:
        values, slopes = rows.values(q), rows.slopes(q)
        for i in np.flatnonzero(rows.excess(q) > -slack):
            least, most = rows.bounds[i]
            inset = min(slack, 0.5 * (most - least))
            for sign, end in ((1.0, most - inset), (-1.0, -least - inset)):
                if np.isfinite(end) and sign * values[i] > end - slack:
                    yield sign * slopes[i], float(sign * slopes[i] @ q.ravel() + end - sign * values[i])
