"""What drives a robot: tendons, chambers and the stage of one segment, and rows times the whole configuration.

A line that runs parallel to the backbone at distance `radius`, on the side at angle `a` about it, has through one
segment of length `l` and bending vector `u` the length `l - radius (ux cos a + uy sin a)`: shorter on the side bent
to (Webster & Jones 2010, section 3). A tendon that ends at segment k runs through segments 1 to k and adds up what
each of them does to it.

A motor makes a value of the displacement of its actuator: gain x displacement + offset, in a unit of its own. The
displacement is what the geometry knows: of a tendon how far it is pulled, of a chamber or a stage its length, of a row
of `Actuators` the row times the configuration. A gain below 0 turns the sign.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from inspect import cleandoc
from typing import Any, ClassVar

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import HasArray, Limits, Names, Number, Rows, Truth, Vector, Whole
from sinuous.base.checks import Floats, listed, listed_names, optional_name
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, Noun

Each = Number | Vector
"""One number for all motors, or one for each."""

Units = str | Sequence[str | None]
"""One unit for all motors, or one for each."""


class Motors(Frozen):
    """Gains, offsets and units of some motors.

    Parameters
    ----------
    gain, offset : ndarray (m,)
    unit : tuple of str or None (m)
    """

    gain: Floats
    offset: Floats
    unit: tuple[str | None, ...]

    def __init__(self, gain: Floats, offset: Floats, unit: tuple[str | None, ...]) -> None:
        for array in (gain, offset):
            array.flags.writeable = False
        self._set(gain=gain, offset=offset, unit=unit)

    @classmethod
    def of(cls, count: int, gain: float | Floats, offset: float | Floats, unit: Any) -> "Motors":
        """Make `count` motors of what stands for all or for each."""
        units = unit if isinstance(unit, tuple) else (unit,) * count
        return cls(np.full(count, gain), np.full(count, offset), units)

    def __len__(self) -> int:
        return len(self.gain)

    def values(self, displacements: Floats) -> Floats:
        """Values of the motors (..., m) at these displacements (..., m)."""
        return self.gain * displacements + self.offset

    def displacements(self, values: Floats) -> Floats:
        """Displacements (..., m) at these values of the motors (..., m)."""
        return (values - self.offset) / self.gain

    def speeds(self, displacements: Floats) -> Floats:
        """How fast the values change (..., m) when displacements do so (..., m); accelerations, too."""
        return self.gain * displacements

    def within(self, changes: Floats) -> Floats:
        """By how much displacements may change (m,) when the values may by so much, to either side."""
        return changes / np.abs(self.gain)

    def limits_of_values(self, displacements: Floats) -> Floats:
        """Least and largest values (m, 2) for the least and largest displacements (m, 2)."""
        return _ordered(self.values(displacements.T).T)

    def limits_of_displacements(self, values: Floats) -> Floats:
        """Least and largest displacements (m, 2) for the least and largest values (m, 2)."""
        return _ordered(self.displacements(values.T).T)


def _ordered(limits: Floats) -> Floats:
    """Sort each row, read-only: a gain below 0 turns limits round."""
    return checks.closed(np.sort(limits, axis=1))


def checked_gain(value: Any, count: int) -> float | Floats:
    """Check a gain for all motors, or one for each; none is 0."""
    gain = checked_each("gain", value, count)
    if not np.all(gain):
        raise InputError("gain", "is 0, so the motor moves nothing", value, "numbers other than 0")
    return gain


def checked_unit(value: Any, count: int) -> str | tuple[str | None, ...] | None:
    """Check a unit for all motors, or one for each, or none."""
    if value is None or isinstance(value, str):
        return None if value is None else checks.text("unit", value)
    units = listed("unit", value, count, f"a text, or a list of {count} texts")
    return tuple(None if unit is None else checks.text(f"unit[{i}]", unit) for i, unit in enumerate(units))


def checked_each(key: str, value: Any, count: int, low: float = -math.inf, above: float = -math.inf) -> float | Floats:
    """Check a number of at least `low`, and greater than `above`, for all motors, or one for each."""
    if not isinstance(value, (list, tuple, np.ndarray)) or np.ndim(value) == 0:
        return checks.number(key, value, low=low, above=above)
    numbers = checks.array(key, value, (count,), f"one number, or {count}")
    for i, number in enumerate(numbers.tolist()):
        checks.number(f"{key}[{i}]", number, low=low, above=above)
    return numbers


MOST_LINES = 64

HEAD = "Parameters\n----------\n"
"""What stands above the parameters in a docstring, which Python takes the indentation from since 3.13."""

UNLIMITED = (-math.inf, math.inf)

ENDS = 2
"""Numbers of an interval."""

TensionLimits = Limits | Sequence[Number | None]
"""A pair [low, high], or [low, None]."""


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Lines(Noun):
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
    gain, offset : float or array_like (m,)
        Of the motors, for all lines or for each: the value of a motor is gain x displacement + offset (of chambers:
        gain x length + offset). A gain below 0 turns the sign.
    unit : str or list of str, optional
        What the values of the motors count: `counts`, `deg`. Messages, tables and pictures say it.
    limits : (float, float), optional
        Least and largest value of every motor, in its unit.
    stiffness : float or array_like (m,), optional
        Force per length by which a line stretches, for all lines or for each; by default they are rigid. The segment
        needs a stiffness, too; only the ratio of both counts for shapes.
    tension : (float, float), optional
        Least and largest tension of an elastic line, positive where it pulls; None as the second is no limit.
    """

    angles: Floats
    radius: float
    names: tuple[str, ...] | None
    gain: float | Floats
    offset: float | Floats
    unit: str | tuple[str | None, ...] | None
    limits: tuple[float, float]
    stiffness: float | Floats | None
    tension: tuple[float, float] | None

    one_sided: ClassVar[bool] = False
    """Whether an elastic line only pulls."""

    own_limits: ClassVar[str]
    """Which parameter has limits of the displacement."""

    def __init__(
        self,
        count: Whole | None = None,
        radius: Number | None = None,
        angle: Number | None = None,
        *,
        angles: Vector | None = None,
        names: Names | None = None,
        gain: Each = 1.0,
        offset: Each = 0.0,
        unit: Units | None = None,
        limits: Limits | None = None,
        stiffness: Each | None = None,
        tension: TensionLimits | None = None,
    ) -> None:
        if (count is None) == (angles is None):
            problem = "missing" if count is None else "cannot be combined with angles"
            raise InputError("count", problem, count, "either count (and angle) or angles")
        if angles is None:
            number = checks.integer("count", count, 1, MOST_LINES)
            first = checks.number("angle", 0.0 if angle is None else angle)
            values = checks.array("angles", first + 2.0 * math.pi * np.arange(number) / number, (number,))
        else:
            if angle is not None:
                raise InputError("angle", "cannot be combined with angles", angle, "either count and angle, or angles")
            values = checks.array("angles", angles, (None,))
            checks.integer("angles", len(values), 1, MOST_LINES)
        self._set(angles=values, radius=checks.number("radius", radius, above=0.0))
        m = len(values)
        self._set(names=listed_names(names, m))
        self._set(gain=checked_gain(gain, m), offset=checked_each("offset", offset, m), unit=checked_unit(unit, m))
        self._set(limits=UNLIMITED if limits is None else checks.interval("limits", limits))
        self._set(stiffness=None if stiffness is None else checked_each("stiffness", stiffness, m, above=0.0))
        self._set(tension=_tension(tension, stiffness, self.one_sided))

    @property
    def tensions(self) -> tuple[float, float]:
        """Least and largest tension of each line, where it is elastic."""
        return self.tension or ((0.0 if self.one_sided else -math.inf), math.inf)

    @property
    def stiffnesses(self) -> Floats:
        """Stiffness (m,) of each line; infinite where it is rigid."""
        return checks.closed(np.full(len(self.angles), math.inf if self.stiffness is None else self.stiffness))

    def __init_subclass__(cls) -> None:
        """Put the parameters of all lines before those of a kind of them."""
        common = cleandoc(Lines.__doc__ or "").partition(HEAD)[2]
        cls.__doc__ = cleandoc(cls.__doc__ or "").replace(HEAD, HEAD + common + "\n", 1)

    @cached_property
    def motors(self) -> Motors:
        """The motors of the lines."""
        return Motors.of(len(self.angles), self.gain, self.offset, self.unit)

    @property
    def limited_by(self) -> str:
        """Which parameter says how far the lines may go: `limits`, or `own_limits`."""
        return self.own_limits if self.limits == UNLIMITED else "limits"

    @cached_property
    def displacements(self) -> Floats:
        """Least and largest displacement (m, 2) of each line."""
        own = np.tile(getattr(self, self.limited_by), (len(self.angles), 1))
        own.flags.writeable = False
        return self.motors.limits_of_displacements(own) if self.limited_by == "limits" else own

    @cached_property
    def unstretched(self) -> Floats:
        """Displacements (m, 2) between which rigid lines would have to stay where these are within all their limits."""
        if self.stiffness is None:
            return self.displacements
        return checks.closed(self.displacements - np.array(self.tensions)[::-1] / self.stiffnesses[:, None])

    @cached_property
    def arms(self) -> Floats:
        """Lever arms (m, 2): what one radian of `bend_x` and of `bend_y` takes away from each line's length."""
        return checks.closed(self.radius * np.stack([np.cos(self.angles), np.sin(self.angles)], axis=-1))


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Tendons(Lines):
    """Tendons that end at the end of one segment.

    They pull and do not push. Elastic ones (`stiffness`) stretch under their tension, and go slack without one.

    Parameters
    ----------
    displacement : (float, float), optional
        Least and largest displacement that the drive allows, in the length unit; 0, the straight robot, must lie
        between. Positive is pulled: the tendon is shorter than the backbone it runs along. Limits of what the motors
        count are `limits` instead.
    straight : bool
        Whether they run straight from disk to disk, which stand at the ends of the arcs of a segment (`arcs`), instead
        of along the body. It matters under load.
    """

    displacement: tuple[float, float]
    straight: bool

    own_limits: ClassVar[str] = "displacement"
    one_sided: ClassVar[bool] = True

    def __init__(
        self,
        count: Whole | None = None,
        radius: Number | None = None,
        angle: Number | None = None,
        *,
        angles: Vector | None = None,
        displacement: Limits | None = None,
        names: Names | None = None,
        gain: Each = 1.0,
        offset: Each = 0.0,
        unit: Units | None = None,
        limits: Limits | None = None,
        stiffness: Each | None = None,
        tension: TensionLimits | None = None,
        straight: Truth = False,
    ) -> None:
        motors: dict[str, Any] = {"gain": gain, "offset": offset, "unit": unit, "limits": limits}
        motors |= {"stiffness": stiffness, "tension": tension}
        super().__init__(count, radius, angle, angles=angles, names=names, **motors)
        _refuse_both("displacement", displacement, limits)
        self._set(straight=checks.truth("straight", straight))
        self._set(displacement=_about_zero(displacement))
        for upright, (low, high) in zip(self.motors.offset.tolist(), self.displacements.tolist(), strict=True):
            if not low <= 0.0 <= high:
                wanted = f"[low, high] with low <= {upright:g} <= high"
                raise InputError("limits", "excludes the straight robot", limits, wanted)
        if (self.unstretched[:, 1] < 0.0).any():
            wanted = f"a least one that stretches tendons by no more than {float(self.displacements[:, 1].min()):g}"
            raise InputError("tension", "excludes the straight robot", self.tension, wanted)


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Chambers(Lines):
    """Pneumatic or bellows chambers along one segment.

    Parameters
    ----------
    length : (float, float), optional
        Shortest and longest that a chamber may be, in the length unit. Limits of what the motors count are `limits`
        instead.
    """

    length: tuple[float, float]

    own_limits: ClassVar[str] = "length"
    one_sided: ClassVar[bool] = False

    def __init__(
        self,
        count: Whole | None = None,
        radius: Number | None = None,
        angle: Number | None = None,
        *,
        angles: Vector | None = None,
        length: Limits | None = None,
        names: Names | None = None,
        gain: Each = 1.0,
        offset: Each = 0.0,
        unit: Units | None = None,
        limits: Limits | None = None,
        stiffness: Each | None = None,
        tension: TensionLimits | None = None,
    ) -> None:
        motors: dict[str, Any] = {"gain": gain, "offset": offset, "unit": unit, "limits": limits}
        motors |= {"stiffness": stiffness, "tension": tension}
        super().__init__(count, radius, angle, angles=angles, names=names, **motors)
        _refuse_both("length", length, limits)
        self._set(length=UNLIMITED if length is None else checks.interval("length", length, low=0.0))


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Stage(Noun):
    """A motor that sets the length of a segment: an insertion stage, where the segment cannot bend.

    Its limits are those of the length of the segment.

    Parameters
    ----------
    gain, offset : float
        The value of the motor is gain x length + offset. A gain below 0 turns the sign.
    unit : str, optional
        What the value counts: `counts`, `deg`.
    name : str, optional
        By default the name of the segment.
    """

    gain: float
    offset: float
    unit: str | None
    name: str | None

    def __init__(
        self, gain: Number = 1.0, offset: Number = 0.0, unit: str | None = None, name: str | None = None
    ) -> None:
        self._set(gain=checked_gain(checks.number("gain", gain), 1), offset=checks.number("offset", offset))
        self._set(unit=None if unit is None else checks.text("unit", unit), name=optional_name(name))

    @property
    def motors(self) -> Motors:
        """The motor."""
        return Motors.of(1, self.gain, self.offset, self.unit)


def _tension(value: TensionLimits | None, stiffness: Each | None, one_sided: bool) -> tuple[float, float] | None:
    """Check limits of the tension, which only elastic lines have; of those that only pull it is at least 0."""
    if value is None:
        return None
    if stiffness is None:
        raise InputError("tension", "needs a stiffness", value, "a stiffness, too")
    if isinstance(value, list | tuple) and len(value) == ENDS and value[1] in (None, math.inf):
        return checks.number("tension[0]", value[0], low=0.0 if one_sided else -math.inf), math.inf
    return checks.interval("tension", value, low=0.0 if one_sided else -math.inf)


def _refuse_both(key: str, own: Limits | None, limits: Limits | None) -> None:
    if own is not None and limits is not None:
        raise InputError("limits", f"cannot be combined with {key}", limits, f"one of {key}, limits")


def _about_zero(value: Limits | None) -> tuple[float, float]:
    if value is None:
        return UNLIMITED
    pair = checks.interval("displacement", value)
    if not pair[0] <= 0.0 <= pair[1]:
        raise InputError("displacement", "excludes the straight robot", value, "[low, high] with low <= 0 <= high")
    return pair


MOST_ACTUATORS = 10_000

RowLimits = HasArray | Sequence[Number | Vector | None]
"""A pair [low, high] for all rows, or one for each; None stands for no limits."""


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Actuators(Noun):
    """Actuators whose values are linear in the configuration of the whole robot.

    Parameters
    ----------
    matrix : array_like (m, 3 n)
        One row an actuator: its displacement is this row times the configuration, written as `bend_x, bend_y, length`
        of the first segment, of the second, and so on. Any unit.
    names : list of str, optional
        By default `a1`, `a2`, ...
    limits : (float, float) or list of these, optional
        Least and largest value, for all actuators or for each; None in the list stands for no limits. The robot
        says which rows may have limits.
    gain, offset : float or array_like (m,)
        For all actuators or for each: its value is gain x displacement + offset. A gain below 0 turns the sign.
    unit : str or list of str, optional
        What the values count: `counts`, `deg`; None in the list stands for none.

    Raises
    ------
    InputError
        When a row is zero, or limits or names are not as many as rows.
    """

    matrix: Floats
    names: tuple[str, ...]
    limits: tuple[tuple[float, float], ...]
    gain: float | Floats
    offset: float | Floats
    unit: str | tuple[str | None, ...] | None

    def __init__(
        self,
        matrix: Rows,
        names: Names | None = None,
        limits: RowLimits | None = None,
        *,
        gain: Each = 1.0,
        offset: Each = 0.0,
        unit: Units | None = None,
    ) -> None:
        rows = checks.array("matrix", matrix, (None, None))
        count = checks.integer("len(matrix)", len(rows), 1, MOST_ACTUATORS)
        for i, row in enumerate(rows):
            if not row.any():
                raise InputError(f"matrix[{i}]", "", row.tolist(), "a row that is not zero")
        own = listed_names(names, count) or tuple(f"a{i + 1}" for i in range(count))
        self._set(matrix=rows, names=own, limits=_limits(limits, count), gain=checked_gain(gain, count))
        self._set(offset=checked_each("offset", offset, count), unit=checked_unit(unit, count))

    @property
    def motors(self) -> Motors:
        """The motors of the rows."""
        return Motors.of(len(self.matrix), self.gain, self.offset, self.unit)

    @property
    def displacements(self) -> Floats:
        """Least and largest displacement (m, 2) of each row."""
        return self.motors.limits_of_displacements(np.array(self.limits))


def _limits(value: Any, count: int) -> tuple[tuple[float, float], ...]:
    if value is None:
        return (UNLIMITED,) * count
    entries = list(value) if isinstance(value, (list, tuple, np.ndarray)) else []
    if len(entries) == 2 and all(np.ndim(end) == 0 and end is not None for end in entries):
        return (checks.interval("limits", entries),) * count
    if len(entries) != count:
        raise InputError("limits", "", value, f"[low, high], or a list of {count} of these")
    return tuple(
        UNLIMITED if e is None or (isinstance(e, tuple) and e == UNLIMITED) else checks.interval(f"limits[{i}]", e)
        for i, e in enumerate(entries)
    )
