"""Where segments go when limits of actuators are to be kept: a shape within all limits that is nearly straight."""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.packing import ANY_LENGTH, BendLine
from sinuous.kernels.tables import FIRST_SEGMENT, LAST_SEGMENT, MAX_VALUE, MIN_VALUE, WEIGHTS
from sinuous.model.coordinates import Coordinates

ROUNDS = 5000
"""Most rounds of projections on all limits by turns (von Neumann)."""

ROUNDING = 1e-12
"""By how much, relative to their weights, home may be outside limits of actuators."""

Home = tuple[float, float, float]
"""Bend, and length: -1 where any length will do."""


def find_home(coordinates: Coordinates, actuation: Floats) -> list[Home]:
    """Home of each segment; where all may be straight at any length, it is that.

    Parameters
    ----------
    coordinates : Coordinates
    actuation : ndarray (p, 7)
        Limits of actuators, laid out as `sinuous.kernels.tables` says.

    Raises
    ------
    InputError
        When limits of actuators leave no shape of what is locked, or in one plane.
    """
    if coordinates.free:
        return [ANY_LENGTH] * len(coordinates.bends)
    bends = np.array([each.home if isinstance(each, BendLine) else (0.0, 0.0) for each in coordinates.bends])
    low, high = coordinates.lengths.T
    shape = np.column_stack([bends, 0.5 * (low + high)])
    rows = _rows(actuation, len(bends))
    sizes = np.abs(rows).sum(axis=1)
    least, most = actuation[:, MIN_VALUE], actuation[:, MAX_VALUE]
    straight = rows.reshape(len(rows), len(bends), 3)
    middle, spread = rows @ shape.ravel(), 0.5 * (np.abs(straight[..., 2]) @ (high - low))
    slack = ROUNDING * sizes
    if ((middle - spread >= least - slack) & (middle + spread <= most + slack)).all():
        return [(float(x), float(y), -1.0) for x, y in bends]
    basis = coordinates.basis * coordinates.scales
    seen = rows @ basis
    squares = (seen**2).sum(axis=1)
    for _ in range(ROUNDS):
        values = rows @ shape.ravel()
        if ((values >= least - slack) & (values <= most + slack)).all():
            return [(float(x), float(y), float(z)) for x, y, z in shape]
        for i in range(len(rows)):
            value = float(rows[i] @ shape.ravel())
            gap = min(max(value, least[i]), most[i]) - value
            if gap != 0.0 and squares[i] > 0.0:
                shape = shape + (basis @ seen[i] * (gap / squares[i])).reshape(shape.shape)
        shape = coordinates.project(shape)
    raise InputError(
        "actuators", "no shape is within their limits and what is locked or in one plane", None, "wider limits"
    )


def _rows(actuation: Floats, count: int) -> Floats:
    """Weights (p, 3 n) of limits of actuators."""
    rows = np.zeros((len(actuation), count, 3))
    for row, limit in zip(rows, actuation, strict=True):
        row[int(limit[FIRST_SEGMENT]) : int(limit[LAST_SEGMENT]) + 1] = limit[WEIGHTS : WEIGHTS + 3]
    return rows.reshape(len(actuation), 3 * count)
