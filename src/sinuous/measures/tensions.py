"""Whether tensions within their limits hold a shape without load: a linear program for each. No kernel is used.

Of the lines of `Robot.segments` it asks what `model.elastic` answers in closed form: how much wider limits would have
to be. Arms, moments and displacements are written out from the segments once more.
"""

from collections.abc import Iterator

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.actuators import Lines
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment

ROUNDING = 1e-9
"""By how much moments may be out of balance, as a share of the largest."""


def lacking_stretch(robot: Robot, q: Floats) -> float:
    """Return by how much limits of tensions and displacements would have to be wider for a shape (n, 3) to be held.

    In the length unit: by how much lines would be stretched. 0 where tensions within them hold it; infinite where no
    tensions do.
    """
    from scipy.optimize import linprog  # noqa: PLC0415

    lines = [(k, *each) for k, segment in enumerate(robot.rows) for each in _elastic(segment)]
    if not lines:
        return 0.0
    arms, bounds = np.zeros((len(lines), *q.shape)), np.zeros((len(lines), 4))
    for row, (k, own, j) in enumerate(lines):
        along = np.array([np.cos(own.angles[j]), np.sin(own.angles[j])]) * own.radius
        if own.one_sided:
            arms[row, robot.drive.before : k + 1, :2] = along
        else:
            arms[row, k] = [*-along, 1.0]
        bounds[row] = *own.tensions, *own.displacements[j]
    stiff = np.array([own.stiffnesses[j] for _, own, j in lines])
    pulled = (arms != 0.0).any(axis=0) & _moves(robot)
    needed = np.array([_moments(segment, one) for segment, one in zip(robot.rows, q, strict=True)])
    pulled |= _moves(robot) & [True, True, False] & _stiff(robot)[:, None] & ~_driven(robot)
    there, size = np.tensordot(arms, q, 2), max(float(np.abs(needed[pulled]).max(initial=0.0)), 1e-300)
    # Tensions t and the lack s: low - s <= t / K <= high + s, and the same of displacements a . q + t / K.
    over = np.concatenate([np.eye(len(lines)), -np.eye(len(lines))] * 2) / np.tile(stiff, 4)[:, None]
    ends = [bounds[:, 1] / stiff, -bounds[:, 0] / stiff, bounds[:, 3] - there, there - bounds[:, 2]]
    most = np.concatenate(ends)
    kept = np.isfinite(most)
    slack, balance = ROUNDING * size, arms[:, pulled].T
    rows = np.concatenate([np.column_stack([over, -np.ones(len(over))])[kept], *_both(balance)])
    values = np.concatenate([most[kept], needed[pulled] + slack, slack - needed[pulled]])
    least = [(None, None)] * len(lines)
    found = linprog([0.0] * len(lines) + [1.0], A_ub=rows, b_ub=values, bounds=[*least, (0.0, None)])
    return float(found.x[-1]) if found.status == 0 and found.x is not None else np.inf


def _both(balance: Floats) -> tuple[Floats, Floats]:
    """Rows of moments from above and from below, with a column of zeros."""
    wide = np.column_stack([balance, np.zeros(len(balance))])
    return wide, -wide


def _elastic(segment: Segment) -> Iterator[tuple[Lines, int]]:
    for lines in (segment.tendons, segment.chambers):
        if lines is not None and lines.stiffness is not None:
            yield from ((lines, j) for j in range(len(lines.angles)))


def _moves(robot: Robot) -> np.ndarray:
    """Which coordinates (n, 3) can move."""
    return np.array(robot.drive.coordinates.unlocked)


def _stiff(robot: Robot) -> np.ndarray:
    return np.array([each.stiffness is not None for each in robot.rows])


def _driven(robot: Robot) -> np.ndarray:
    """Which coordinates (n, 3) rigid actuators move."""
    names = [each.name for each in robot.actuators]
    jacobian = robot.drive.jacobian.reshape(len(names), len(robot), 3)
    rigid = np.ones(len(names), np.bool_)
    if robot.drive.elastic is not None:
        rigid[robot.drive.elastic.places] = False
    return (jacobian[rigid] != 0.0).any(axis=0)


def _moments(segment: Segment, q: Floats) -> tuple[float, float, float]:
    """What a segment resists with: moments of both bends, and the force of its length."""
    own = segment.stiffness
    if own is None:
        return 0.0, 0.0, 0.0
    mean = 0.5 * sum(segment.length)
    pushed = segment.chambers is not None and segment.chambers.stiffness is not None
    length = mean if pushed or segment.length[0] == segment.length[1] else q[2]
    stretch = 0.0 if np.isinf(own.stretch) else own.stretch / mean * (q[2] - mean)
    x, y = own.bend / length * (q[:2] - segment.rest)
    return float(x), float(y), float(stretch)
