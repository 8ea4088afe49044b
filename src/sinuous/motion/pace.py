"""Motions in times within rates: every step takes as long as the robot needs for it.

A step is linear in q, so its speed is even. Where accelerations are limited, the speed changes at a knot by no more
than that in the mean of the durations beside it, at both ends in half of one, as for plans in time.
"""

from typing import NamedTuple

import numpy as np

from sinuous.answer.status import Status
from sinuous.base import checks
from sinuous.base.arguments import Number
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot
from sinuous.motion.motion import Motion
from sinuous.motion.timing import largest, motor_speeds
from sinuous.scene.snapshot import Snapshot

ROUNDING = 1e-9
"""Share of a duration that it may be too short by."""


PATIENCE = 8.0
"""How many times as long as the straight way the robot may be on its way after all obstacles have come to rest."""


def pace_motion(motion: Motion, rates: Rates | None, duration: float | None = None, *, asked: bool = False) -> Motion:
    """Return a motion with times in which it keeps its rates; the same one where there is nothing to keep.

    Parameters
    ----------
    motion : Motion
    rates : Rates, optional
    duration : float, optional
        How long it has to take, with all that is saved for all steps alike.
    asked : bool
        Whether its times were asked for. Then they stay, as long as rates are kept; else all are longer by one factor,
        and the motion is `rate_bound`. Where obstacles move, which were looked at in these times, they stay in any
        case. By default a motion is as fast as rates allow, and what nothing limits takes as long as it did.
    """
    if not rates or len(motion.configuration) < 2:
        return motion
    robot, q, spread = motion.robot, motion.configuration, rates.spread(motion.robot)
    moves = np.diff(q, axis=0)
    least = 1.0 / largest(robot, spread, moves, motor_speeds(robot, spread, q[:-1], moves))
    given = np.diff(motion.times)
    fixed = asked or duration is not None or motion.scene.moves
    durations = given if asked or motion.scene.moves else np.where(least > 0.0, least, given)
    if duration is not None and not motion.scene.moves:
        durations = durations * (duration / durations.sum())
    factor = max(1.0, float((least / durations).max()))
    factor = max(factor, _slower(robot, q, durations, rates))
    late = fixed and factor > 1.0 + ROUNDING
    times = motion.times
    if not motion.scene.moves:
        times = np.concatenate([times[:1], times[0] + np.cumsum(factor * durations)])
    solved = motion.status in (Status.SOLVED, Status.UNPROVED, Status.LEFT_PATH)
    return motion.with_times(times, Status.RATE_BOUND if late and solved else None)


def _slower(robot: Robot, q: Floats, durations: Floats, rates: Rates) -> float:
    """By which factor all durations (T - 1,) have to be longer for the accelerations."""
    accelerations = rates.further(robot)
    if accelerations is None:
        return 1.0
    beside = np.concatenate([[0.0], durations, [0.0]])
    means = 0.5 * (beside[1:] + beside[:-1])

    def gained(places: Floats) -> Floats:
        """How fast mean speeds of steps between places (T, ...) change, from rest to rest."""
        slope = (len(durations), *[1] * (places.ndim - 1))
        still = np.zeros((1, *places.shape[1:]))
        speeds = np.concatenate([still, np.diff(places, axis=0) / durations.reshape(slope), still])
        return np.diff(speeds, axis=0) / means.reshape(-1, *slope[1:])

    motors = gained(robot.drive.values(q)) if accelerations.limits_elastic(robot) else None
    most = largest(robot, accelerations, gained(q), motors)
    return float(np.sqrt(max(1.0, (1.0 / most).max())))


class Pace(NamedTuple):
    """How fast a motion is: its rates, when it begins, and how long it takes.

    Attributes
    ----------
    rates : Rates or None
    begin : float
    duration : float or None
        As short as is found, when there are rates.
    timed : bool
        Whether waypoints have times.
    """

    rates: Rates | None = None
    begin: float = 0.0
    duration: float | None = None
    timed: bool = False

    @classmethod
    def of(
        cls,
        robot: Robot,
        rates: Rates | None = None,
        duration: Number | None = None,
        begin: Number = 0.0,
        times: Floats | None = None,
    ) -> "Pace":
        """Check what a user says; `times` are those of waypoints.

        Raises
        ------
        InputError
        """
        checks.instance("rates", rates, Rates | None, "Rates")
        if rates:
            with checks.inside("rates"):
                rates.check(robot)
        if duration is not None and times is not None:
            raise InputError("duration", "cannot be combined with times", duration, "one of duration, times")
        long = None if duration is None else checks.number("duration", duration, above=0.0)
        return cls(rates or None, checks.number("begin", begin), long, times is not None)

    def check(self, scene: Snapshot) -> None:
        """Refuse what is missing, or not kept, in a scene.

        Raises
        ------
        InputError
        """
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
        return self.begin + (1.0 if self.duration is None else self.duration) * shares

    def waypoints(self, count: int, started: bool) -> Floats | None:
        """Times (m,) of waypoints where a duration is given: even ones."""
        steps = count - 1 + started
        if self.duration is None or steps == 0:
            return None
        return np.linspace(0.0, self.duration, steps + 1)[int(started) :]

    def kept(self, motion: Motion) -> Motion:
        """Return the motion in times that keep the rates."""
        return pace_motion(motion, self.rates, self.duration, asked=self.timed)
