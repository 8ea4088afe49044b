"""Actuators that see any coordinates of the robot: antagonistic pairs, differentials, stages."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.arguments import HasArray, Names, Number, Rows, Vector
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.frozen import Frozen
from sinuous.robot.names import listed_names

MOST_ACTUATORS = 10_000

UNLIMITED = (-math.inf, math.inf)

RowLimits = HasArray | Sequence[Number | Vector | None]
"""A pair [low, high] for all rows, or one for each; None stands for no limits."""


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Actuators(Frozen):
    """Actuators whose values are linear in the configuration of the whole robot.

    Parameters
    ----------
    matrix : array_like (m, 3 n)
        One row an actuator: its value is this row times the configuration, written as `bend_x, bend_y, length` of the
        first segment, of the second, and so on. Any unit.
    names : list of str, optional
        By default `a1`, `a2`, ...
    limits : (float, float) or list of these, optional
        Least and largest value, for all actuators or for each; None in the list stands for no limits. The robot
        says which rows may have limits.

    Raises
    ------
    InputError
        When a row is zero, or limits or names are not as many as rows.
    """

    matrix: Floats
    names: tuple[str, ...]
    limits: tuple[tuple[float, float], ...]

    def __init__(self, matrix: Rows, names: Names | None = None, limits: RowLimits | None = None) -> None:
        rows = checks.array("matrix", matrix, (None, None))
        count = checks.integer("len(matrix)", len(rows), 1, MOST_ACTUATORS)
        for i, row in enumerate(rows):
            if not row.any():
                raise InputError(f"matrix[{i}]", "", row.tolist(), "a row that is not zero")
        own = listed_names(names, count) or tuple(f"a{i + 1}" for i in range(count))
        self._set(matrix=rows, names=own, limits=_limits(limits, count))


def _limits(value: Any, count: int) -> tuple[tuple[float, float], ...]:
    if value is None:
        return (UNLIMITED,) * count
    entries = list(value) if isinstance(value, (list, tuple, np.ndarray)) else []
    if len(entries) == 2 and all(np.ndim(end) == 0 and end is not None for end in entries):
        return (checks.interval("limits", entries),) * count
    if len(entries) != count:
        raise InputError("limits", "", value, f"[low, high], or a list of {count} of these")
    return tuple(UNLIMITED if e is None else checks.interval(f"limits[{i}]", e) for i, e in enumerate(entries))
