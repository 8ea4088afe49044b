"""How exactly targets must be met."""

from dataclasses import dataclass

from sinuous import checks
from sinuous.arguments import Number
from sinuous.errors import InputError
from sinuous.frozen import Frozen
from sinuous.robot.robot import Robot

RELATIVE_POSITION = 1e-4
ANGLE = 1e-3


@dataclass(frozen=True, init=False, repr=False)
class Tolerance(Frozen):
    """How far an answer may be from its targets, inclusive.

    Parameters
    ----------
    position : float, optional
        In the length unit; default 1e-4 of the sum of the mean segment lengths.
    angle : float
        In rad.
    """

    position: float | None
    angle: float

    def __init__(self, position: Number | None = None, angle: Number = ANGLE) -> None:
        self._set(
            position=None if position is None else checks.number("position", position, above=0.0),
            angle=checks.number("angle", angle, above=0.0),
        )

    def for_robot(self, robot: Robot) -> "Tolerance":
        """Fill in the default position tolerance."""
        return Tolerance(RELATIVE_POSITION * robot.mean_length, self.angle) if self.position is None else self


def as_tolerance(tolerance: Tolerance | None) -> Tolerance:
    """Check tolerances; `None` stands for the defaults."""
    if tolerance is None:
        return Tolerance()
    if not isinstance(tolerance, Tolerance):
        raise InputError("tolerance", "", tolerance, "a Tolerance")
    return tolerance
