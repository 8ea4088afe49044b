"""What a motor makes of the displacement of its actuator: value = gain x displacement + offset, in a unit of its own.

The displacement is what the geometry knows: of a tendon how far it is pulled, of a chamber or a stage its length, of a
row of `Actuators` the row times the configuration. A gain below 0 turns the sign.
"""

import math
from collections.abc import Sequence
from itertools import islice
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.arguments import Number, Vector
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.frozen import Frozen

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
        raise InputError("gain", "a motor that nothing turns", value, "numbers other than 0")
    return gain


def checked_unit(value: Any, count: int) -> str | tuple[str | None, ...] | None:
    """Check a unit for all motors, or one for each, or none."""
    if value is None or isinstance(value, str):
        return None if value is None else checks.text("unit", value)
    units = list(islice(value, count + 1)) if np.iterable(value) and not isinstance(value, (bytes, dict)) else []
    if len(units) != count:
        raise InputError("unit", "", value, f"a text, or a list of {count} texts")
    return tuple(None if unit is None else checks.text(f"unit[{i}]", unit) for i, unit in enumerate(units))


def checked_each(key: str, value: Any, count: int, low: float = -math.inf) -> float | Floats:
    """Check a number of at least `low` for all motors, or one for each."""
    if not isinstance(value, (list, tuple, np.ndarray)) or np.ndim(value) == 0:
        return checks.number(key, value, low=low)
    numbers = checks.array(key, value, (count,), f"one number, or {count}")
    for i, number in enumerate(numbers.tolist()):
        checks.number(f"{key}[{i}]", number, low=low)
    return numbers
