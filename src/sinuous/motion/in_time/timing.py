"""When a plan begins, how long it takes, and how fast the robot may be."""

from typing import Any, NamedTuple

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.robot.rates import Rates
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot

PATIENCE = 8.0
"""How many times as long as the straight way the robot may be on its way after all obstacles have come to rest."""


class Timing(NamedTuple):
    """When a plan begins, and how long it takes.

    Attributes
    ----------
    rates : Rates or None
    begin : float
    duration : float or None
        As short as is found, when there are rates.
    """

    rates: Rates | None = None
    begin: float = 0.0
    duration: float | None = None

    @classmethod
    def of(cls, robot: Robot, given: dict[str, Any]) -> "Timing":
        """Check what a user says.

        Raises
        ------
        InputError
        """
        rates, duration = given.get("rates"), given.get("duration")
        if not (rates is None or isinstance(rates, Rates)):
            raise InputError("rates", "", rates, "Rates")
        if rates:
            with checks.inside("rates"):
                rates.check(robot)
        long = None if duration is None else checks.number("duration", duration, above=0.0)
        return cls(rates or None, checks.number("begin", given.get("begin", 0.0)), long)

    def check(self, scene: Snapshot) -> None:
        """Refuse what is missing, or not kept, in a scene.

        Raises
        ------
        InputError
        """
        if not scene.moves and self.rates is not None:
            raise InputError("rates", "no obstacle moves", self.rates, "none; the motion's timed(rates) keeps them")
        if scene.moves and self.rates is None and self.duration is None:
            raise InputError("rates", "missing: obstacles move", None, "rates, or the duration of the motion")

    def end(self, scene: Snapshot, least: float) -> float:
        """When the motion ends, at the latest, if the straight way takes at least so long."""
        if self.duration is not None:
            return self.begin + self.duration
        rest = max((float(course.times[-1]) for course in scene.courses.values()), default=self.begin)
        return max(rest, self.begin) + PATIENCE * max(least, 1e-6)

    def spread(self, shares: Floats) -> Floats:
        """Times at shares of the motion (T,)."""
        times: Floats = self.begin + (1.0 if self.duration is None else self.duration) * shares
        return times
