"""Limits of `Actuators` as solvers keep them: rows of the table of actuator limits.

Such a row weighs the coordinates of one segment, or the sums over all segments from the first to one. What cannot
move adds a constant, whatever its weight.
"""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE, MAX_LENGTH, MIN_LENGTH
from sinuous.packing import actuator_row
from sinuous.robot.coupled import Actuators

ROUNDING = 1e-13
"""Relative to its values: how near to a limit the straight robot counts as on it, and what the limit is eased by."""


def coupled_rows(linear: Actuators, gains: Floats, limits: Floats) -> Iterator[list[float]]:
    """Yield the rows of the table for those whose limits can be violated at all.

    Parameters
    ----------
    linear : Actuators
    gains : ndarray (m,)
        What their values are divided by, so that they count in the length unit.
    limits : ndarray (n, 7)
        Rows of the segments, laid out as `sinuous.kernels.tables` says.

    Raises
    ------
    InputError
        When a row has limits and is of another form, or when a straight robot would violate them.
    """
    moves = limits[:, [BEND_SCALE, BEND_SCALE, LENGTH_SCALE]] > 0.0
    lengths = limits[:, [MIN_LENGTH, MAX_LENGTH]]
    for i, (row, pair, gain) in enumerate(zip(linear.matrix, linear.limits, gains, strict=True)):
        weights = row.reshape(-1, 3)
        if math.isfinite(pair[0]) or math.isfinite(pair[1]):
            with checks.inside(f"actuators.limits[{i}]"):
                eased = _eased(weights, pair, lengths)
                if (weights[:, :2] * moves[:, :2]).any():  # otherwise straight robots have all its values
                    first, last, *numbers = _row(weights, eased, moves, lengths)
                    yield [first, last, *(number / gain for number in numbers)]


def _eased(weights: Floats, pair: tuple[float, float], lengths: Floats) -> tuple[float, float]:
    """Limits that no straight robot violates by rounding; refused where one violates them by more.

    Solvers count on that: they go back towards the straight robot where actuators hold them.
    """
    ends = weights[:, 2:] * lengths
    low, high = float(ends.min(axis=1).sum()), float(ends.max(axis=1).sum())
    slack = ROUNDING * max(abs(low), abs(high))
    if pair[0] > low + slack or high - slack > pair[1]:
        raise InputError("", "excludes straight robots", pair, f"limits that contain [{low:g}, {high:g}]")
    return min(pair[0], low - slack), max(pair[1], high + slack)


def _row(weights: Floats, pair: tuple[float, float], moves: NDArray[np.bool_], lengths: Floats) -> list[float]:
    seen = np.where(moves, weights, 0.0)
    last = int(np.flatnonzero(seen.any(axis=1))[-1])
    fixed = np.where(moves[:, 2], 0.0, lengths[:, 0])
    constant = float(weights[:, 2] @ fixed)
    if not seen[:last].any():
        return actuator_row(last, last, seen[last].tolist(), (pair[0] - constant, pair[1] - constant))
    common = [seen[: last + 1, c][moves[: last + 1, c]] for c in range(3)]
    if any((column != column[0]).any() for column in common if len(column)):
        raise InputError("", "", pair, "none: its weights are not on one segment, nor equal from the first up to one")
    shared = [float(column[0]) if len(column) else 0.0 for column in common]
    shift = shared[2] * float(fixed[: last + 1].sum()) - constant
    return actuator_row(0, last, shared, (pair[0] + shift, pair[1] + shift))
