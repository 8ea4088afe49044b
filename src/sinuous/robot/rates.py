"""How fast a robot may move, and how far it may in a given time."""

from typing import Any, NamedTuple

import numpy as np

from sinuous import checks
from sinuous.arguments import Number, Vector
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.frozen import Frozen
from sinuous.robot.robot import Robot

Most = Number | Vector | None
"""One number for all, or one for each; nothing: no limit."""

KEYS = ("bend", "length", "actuator")


class Spread(NamedTuple):
    """Numbers for every segment and every actuator of a robot; infinite where there is no limit.

    Attributes
    ----------
    bend, length : ndarray (n,)
    actuator : ndarray (m,)
    """

    bend: Floats
    length: Floats
    actuator: Floats


class _Bounds(Frozen):
    """Numbers that bound bends, lengths and actuators: one for all, one for each, or none."""

    bend: float | Floats | None
    length: float | Floats | None
    actuator: float | Floats | None

    def __init__(self, bend: Most = None, length: Most = None, actuator: Most = None) -> None:
        self._set(**{key: _most(key, value) for key, value in zip(KEYS, (bend, length, actuator), strict=True)})

    def _times(self, factor: float) -> "Changes":
        return Changes(*(None if own is None else own * factor for own in (getattr(self, key) for key in KEYS)))

    def spread(self, robot: Robot) -> Spread:
        """Return the numbers for every segment and every actuator of a robot; without accelerations.

        Raises
        ------
        InputError
            When there are not as many as it has.
        """
        counts = len(robot), len(robot), len(robot.actuators)
        return Spread(*(_spread(key, getattr(self, key), count) for key, count in zip(KEYS, counts, strict=True)))


class Changes(_Bounds):
    """The largest changes that are allowed, of a configuration and of actuators; `2 * changes` are twice as large.

    Parameters
    ----------
    bend : float or array_like (n,), optional
        Of the bending vector of a segment: the norm of its change, rad.
    length : float or array_like (n,), optional
        Of the length of a segment.
    actuator : float or array_like (m,), optional
        Of the value of an actuator, in the order of `Robot.actuators`: units of its motor (length unit without a gain).

    Raises
    ------
    InputError
        When a number is not greater than 0.
    """

    def __mul__(self, factor: Number) -> "Changes":
        return self._times(checks.number("factor", factor, above=0.0))

    __rmul__ = __mul__


class Rates(_Bounds):
    """The largest speeds of a robot, per second: scalars for all, or one for each.

    `rates * dt` are the `Changes` that are allowed in `dt` seconds. Accelerations say nothing about one such time
    alone, and are not part of them.

    Parameters
    ----------
    bend : float or array_like (n,), optional
        Of the bending vector of a segment, rad/s: the norm of its derivative.
    length : float or array_like (n,), optional
        Of the length of a segment, length unit/s.
    actuator : float or array_like (m,), optional
        Of the value of an actuator, in the order of `Robot.actuators`: units of its motor a second
        (length unit/s without a gain).
    acceleration : Rates, optional
        The same of their derivatives: rad/s^2, length unit/s^2.

    Raises
    ------
    InputError
        When a number is not greater than 0, or the acceleration has an acceleration.
    """

    acceleration: "Rates | None"

    def __init__(
        self, bend: Most = None, length: Most = None, actuator: Most = None, acceleration: "Rates | None" = None
    ) -> None:
        super().__init__(bend, length, actuator)
        if acceleration is not None and not isinstance(acceleration, Rates):
            raise InputError("acceleration", "", acceleration, "Rates")
        if acceleration is not None and acceleration.acceleration is not None:
            raise InputError("acceleration.acceleration", "", acceleration.acceleration, "nothing")
        self._set(acceleration=acceleration)

    def __bool__(self) -> bool:
        return any(getattr(self, key) is not None for key in (*KEYS, "acceleration"))

    def __mul__(self, dt: Number) -> Changes:
        return self._times(checks.number("dt", dt, above=0.0))

    __rmul__ = __mul__

    def check(self, robot: Robot) -> None:
        """Refuse rates and accelerations that are not as many as a robot has segments and actuators.

        Raises
        ------
        InputError
        """
        self.spread(robot)
        if self.acceleration is not None:
            with checks.inside("acceleration"):
                self.acceleration.spread(robot)


def _most(key: str, value: Any) -> float | Floats | None:
    """Check a number greater than 0, or several."""
    if value is None:
        return None
    if np.ndim(value) == 0:
        return checks.number(key, value, above=0.0)
    numbers = checks.array(key, value, (None,))
    for i, number in enumerate(numbers.tolist()):
        checks.number(f"{key}[{i}]", number, above=0.0)
    return numbers


def _spread(key: str, value: float | Floats | None, count: int) -> Floats:
    if value is None:
        return np.full(count, np.inf)
    if isinstance(value, float):
        return np.full(count, value)
    if len(value) != count:
        raise InputError(key, "", value.tolist(), f"one number, or {count}")
    return value
