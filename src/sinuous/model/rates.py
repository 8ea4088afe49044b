"""How fast a robot may move, and how far it may in a given time."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Vector
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, shown, suggested
from sinuous.base.frozen import Frozen
from sinuous.model.robot import Robot

Most = Number | Vector | Mapping[str, Number] | None
"""One number for all, or one for each, or some by their names; nothing: no limit."""

Kept = float | Floats | dict[str, float] | None
"""The same as it is kept."""

KEYS = ("bend", "length", "actuator", "joint")


class Spread(NamedTuple):
    """Numbers for every row and every actuator of a robot; infinite where there is no limit.

    Attributes
    ----------
    bend, length : ndarray (rows,)
        Those of joints that turn are bends, those of joints that slide lengths.
    actuator : ndarray (m,)
    """

    bend: Floats
    length: Floats
    actuator: Floats

    def limits_elastic(self, robot: Robot) -> bool:
        """Whether elastic actuators of a robot are limited: the speeds of their motors depend on where it is."""
        elastic = robot.drive.elastic
        return elastic is not None and bool(np.isfinite(self.actuator[elastic.places]).any())


class _Bounds(Frozen):
    """Numbers that bound bends, lengths, actuators and joints: one for all, one for each, some by names, or none."""

    bend: Kept
    length: Kept
    actuator: Kept
    joint: Kept

    def __init__(self, bend: Most = None, length: Most = None, actuator: Most = None, joint: Most = None) -> None:
        self._set(**{key: _most(key, value) for key, value in zip(KEYS, (bend, length, actuator, joint), strict=True)})

    def _times(self, factor: float) -> "Changes":
        return Changes(*(scaled(getattr(self, key), factor) for key in KEYS))

    def spread(self, robot: Robot) -> Spread:
        """Return the numbers for every row and every actuator of a robot; without accelerations.

        Raises
        ------
        InputError
            When there are not as many as it has, or none has such a name.
        """
        return self._spread(robot, np.inf)

    def _spread(self, robot: Robot, joints: Any) -> Spread:
        """The same where the joints have limits (j,) of their own: the stricter of both holds."""
        arcs, rigid = robot.segment_names, robot._rigid
        names = arcs, arcs, [actuator.name for actuator in robot.actuators], robot.joint_names
        bend, length, actuator, own = (
            _spread(key, getattr(self, key), named) for key, named in zip(KEYS, names, strict=True)
        )
        both = np.full((len(robot), 2), np.inf)
        both[len(rigid.rows) :] = np.stack([bend, length], axis=1)
        both[rigid.values, (rigid.columns > 0).astype(np.intp)] = np.minimum(own, joints)
        result, elastic = Spread(both[:, 0], both[:, 1], actuator), robot.drive.elastic
        if elastic is not None and result.limits_elastic(robot) and not elastic.rows.decoupled:
            problem = "elastic lines end at a segment that they cannot bend"
            raise InputError("actuator", problem, self.actuator, "none for elastic actuators")
        return result


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
    joint : float or array_like (j,), optional
        Of the value of a joint, in the order of `Robot.joint_names`: rad, or the length unit.

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
    alone, and are not part of them. Where rates are given, and in every control step, a joint keeps its own `rate` and
    `acceleration`, too: the stricter of both.

    Parameters
    ----------
    bend : float, array_like (n,) or mapping, optional
        Of the bending vector of a segment, rad/s: the norm of its derivative. A mapping has the names of segments;
        what it does not name has no limit.
    length : float, array_like (n,) or mapping, optional
        Of the length of a segment, length unit/s.
    actuator : float, array_like (m,) or mapping, optional
        Of the value of an actuator, in the order of `Robot.actuators`: units of its motor a second
        (length unit/s without a gain). Values of elastic ones include their stretch, and keep this all along a step.
    acceleration : Rates, optional
        The same of their derivatives: rad/s^2, length unit/s^2.
    joint : float, array_like (j,) or mapping, optional
        Of the value of a joint, in the order of `Robot.joint_names`: rad/s, or length unit/s.

    Raises
    ------
    InputError
        When a number is not greater than 0, or the acceleration has an acceleration.
    """

    acceleration: "Rates | None"

    def __init__(
        self,
        bend: Most = None,
        length: Most = None,
        actuator: Most = None,
        acceleration: "Rates | None" = None,
        joint: Most = None,
    ) -> None:
        super().__init__(bend, length, actuator, joint)
        checks.instance("acceleration", acceleration, Rates | None, "Rates")
        if acceleration is not None and acceleration.acceleration is not None:
            raise InputError("acceleration.acceleration", "", acceleration.acceleration, "nothing")
        self._set(acceleration=acceleration)

    def __bool__(self) -> bool:
        return any(getattr(self, key) is not None for key in (*KEYS, "acceleration"))

    def __mul__(self, dt: Number) -> Changes:
        return self._times(checks.number("dt", dt, above=0.0))

    __rmul__ = __mul__

    def check(self, robot: Robot) -> None:
        """Refuse rates and accelerations that are not as many as a robot has segments, actuators and joints.

        Raises
        ------
        InputError
        """
        self.spread(robot)
        self.further(robot)

    def spread(self, robot: Robot) -> Spread:
        """Return the rates of every row and every actuator of a robot, with those that its joints have themselves.

        Raises
        ------
        InputError
            When there are not as many as it has, or none has such a name.
        """
        return self._spread(robot, [joint.rate for joint in robot._rigid.moving])

    def further(self, robot: Robot) -> Spread | None:
        """Return the accelerations likewise; `None` where nothing limits any.

        Raises
        ------
        InputError
            As for `spread`.
        """
        own = np.array([joint.acceleration for joint in robot._rigid.moving])
        if self.acceleration is None and not np.isfinite(own).any():
            return None
        with checks.inside("acceleration"):
            return (self.acceleration or UNLIMITED)._spread(robot, own)


def _most(key: str, value: Any) -> Kept:
    """Check a number greater than 0, or several."""
    if value is None:
        return None
    if isinstance(value, Mapping):
        return {str(name): checks.number(f"{key}.{name}", each, above=0.0) for name, each in value.items()}
    if np.ndim(value) == 0:
        return checks.number(key, value, above=0.0)
    numbers = checks.array(key, value, (None,))
    for i, number in enumerate(numbers.tolist()):
        checks.number(f"{key}[{i}]", number, above=0.0)
    return numbers


def least(value: Kept) -> float:
    """The least of the numbers; 0 where there is none."""
    return 0.0 if value is None else float(np.min([*value.values()] if isinstance(value, dict) else value))


def scaled(value: Kept, factor: float) -> Kept:
    """The same with every number multiplied."""
    if isinstance(value, dict):
        return {name: factor * own for name, own in value.items()}
    return None if value is None else factor * value


def _spread(key: str, value: Kept, names: Sequence[str]) -> Floats:
    if value is None or isinstance(value, float):
        return np.full(len(names), np.inf if value is None else value)
    if isinstance(value, dict):
        for name in value:
            if name not in names:
                raise InputError(key, f"nothing is called {shown(name)}", name, suggested(name, names))
        return np.array([value.get(name, np.inf) for name in names])
    if len(value) != len(names):
        raise InputError(key, "", value.tolist(), f"one number, or {len(names)}")
    return value


UNLIMITED = Rates()
"""Rates without any limit."""
