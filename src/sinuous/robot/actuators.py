"""What drives a robot: tendons and chambers of one segment, and actuators that are linear in the whole configuration.

A line that runs parallel to the backbone at distance `radius`, on the side at angle `a` about it, has through one
segment of length `l` and bending vector `u` the length `l - radius (ux cos a + uy sin a)`: shorter on the side bent
to (Webster & Jones 2010, section 3). A tendon that ends at segment k runs through segments 1 to k and adds up what
each of them does to it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from sinuous import checks
from sinuous.arguments import HasArray, Limits, Names, Number, Rows, Vector, Whole
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.frozen import Frozen
from sinuous.robot.names import listed_names

MOST_LINES = 64


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Lines(Frozen):
    """Lines parallel to the backbone of a segment.

    Parameters
    ----------
    count : int, optional
        Number of lines, spread evenly from `angle` on.
    angle : float
        Angle of the first of `count` lines about the segment's z axis, rad, from its x axis.
    angles : array_like (m,), optional
        The angles one by one, instead of `count` and `angle`.
    radius : float
        Distance of the lines from the backbone, in the length unit.
    names : list of str, optional
        One for each; by default the robot makes them of the segment's name: `s1.t1`, `s1.c1`.
    """

    angles: Floats
    radius: float
    names: tuple[str, ...] | None

    def __init__(
        self,
        count: Whole | None = None,
        radius: Number | None = None,
        angle: Number | None = None,
        *,
        angles: Vector | None = None,
        names: Names | None = None,
    ) -> None:
        if (count is None) == (angles is None):
            raise InputError("count", "they say where the lines are", count, "either count (and angle) or angles")
        if angles is None:
            number = checks.integer("count", count, 1, MOST_LINES)
            first = checks.number("angle", 0.0 if angle is None else angle)
            values = checks.array("angles", first + 2.0 * math.pi * np.arange(number) / number, (number,))
        else:
            if angle is not None:
                raise InputError("angle", "stands beside angles", angle, "either count and angle, or angles")
            values = checks.array("angles", angles, (None,))
            checks.integer("angles", len(values), 1, MOST_LINES)
        self._set(angles=values, radius=checks.number("radius", radius, above=0.0))
        self._set(names=listed_names(names, len(values)))

    @property
    def arms(self) -> Floats:
        """Lever arms (m, 2): what one radian of `bend_x` and of `bend_y` takes away from each line's length."""
        result: Floats = self.radius * np.stack([np.cos(self.angles), np.sin(self.angles)], axis=-1)
        return result

    def changed(self, **values: Any) -> Self:
        """Return the same lines with other values of some parameters."""
        return self._changed(values)


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Tendons(Lines):
    """Tendons that end at the end of one segment; parameters as `Lines`, and `displacement`.

    Parameters
    ----------
    displacement : (float, float), optional
        Least and largest displacement that the drive allows, in the length unit; 0, the straight robot, must lie
        between. Positive is pulled: the tendon is shorter than the backbone it runs along.
    """

    displacement: tuple[float, float]

    def __init__(
        self,
        count: Whole | None = None,
        radius: Number | None = None,
        angle: Number | None = None,
        *,
        angles: Vector | None = None,
        displacement: Limits | None = None,
        names: Names | None = None,
    ) -> None:
        super().__init__(count, radius, angle, angles=angles, names=names)
        self._set(displacement=_limits_about_zero("displacement", displacement))


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Chambers(Lines):
    """Pneumatic or bellows chambers along one segment; parameters as `Lines`, and `length`.

    Parameters
    ----------
    length : (float, float), optional
        Shortest and longest that a chamber may be, in the length unit.
    """

    length: tuple[float, float]

    def __init__(
        self,
        count: Whole | None = None,
        radius: Number | None = None,
        angle: Number | None = None,
        *,
        angles: Vector | None = None,
        length: Limits | None = None,
        names: Names | None = None,
    ) -> None:
        super().__init__(count, radius, angle, angles=angles, names=names)
        pair = (-math.inf, math.inf) if length is None else checks.interval("length", length, low=0.0)
        self._set(length=pair)


def _limits_about_zero(key: str, value: Limits | None) -> tuple[float, float]:
    if value is None:
        return -math.inf, math.inf
    pair = checks.interval(key, value)
    if not pair[0] <= 0.0 <= pair[1]:
        raise InputError(key, "excludes the straight robot", value, "[low, high] with low <= 0 <= high")
    return pair


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
