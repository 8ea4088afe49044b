"""Times of a motion: those of its knots, of the waypoints of a path, and of a plan."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.motion.configurations import distances
from sinuous.robot.rates import Rates
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot

PATIENCE = 8.0
"""How many times as long as the straight way the robot may be on its way after all obstacles have come to rest."""


def even_times(count: int) -> Floats:
    """Return 0, 1, 2, ... (count,)."""
    return np.arange(float(count))


def with_start(times: Floats) -> Floats:
    """Put the time of the start in front of those of waypoints: as long before the first as the second is after it.

    Before a single waypoint it is 1.
    """
    first = times[1] - times[0] if len(times) > 1 else 1.0
    return np.append(times[0] - first, times)


def spread_times(robot: Robot, q: Floats, fixed: NDArray[np.intp], times: Floats) -> Floats:
    """Return the times (T,) of all knots, when those of some are given.

    Between two of these, time goes on with the distance that `distances` measures, and evenly where that is 0.

    Parameters
    ----------
    robot : Robot
    q : ndarray (T, n, 3)
    fixed : ndarray (k,)
        Knots whose times are given, the first and the last among them.
    times : ndarray (k,)
        Increasing.
    """
    if len(fixed) == len(q):
        return times.copy()
    along = np.concatenate([[0.0], np.cumsum(distances(robot, q))])
    along += np.arange(len(along)) * max(1e-9 * along[-1], np.finfo(float).tiny)
    result: Floats = np.interp(along, along[fixed], times)
    result[fixed] = times
    return result


class Timetable:
    """The times of a start and of waypoints, and the scene as it is then, in which they are solved.

    Parameters
    ----------
    scene : Snapshot
        Whose obstacles move.
    times : ndarray (m,), optional
        Of all waypoints; by default 0, 1, 2, ...
    waypoints : int
    started : bool
        Whether there is a start before the first waypoint: at 0 by default, and the first waypoint at 1.

    Attributes
    ----------
    scene : Snapshot
    live : Scene
        The scene as it is at the time that was looked at last.
    """

    def __init__(self, scene: Snapshot, times: Floats | None, waypoints: int, started: bool) -> None:
        given = even_times(waypoints + started)[started:] if times is None else times
        self._times = with_start(given) if started else given
        self._started = started
        self.scene, self.live = scene, Scene.of(scene.at(float(self._times[0])))

    @property
    def begin(self) -> float:
        """When the motion begins."""
        return float(self._times[0])

    def of(self, waypoint: int) -> float:
        """When the robot is at a waypoint, 0 = first."""
        return float(self._times[waypoint + self._started])

    def look_at(self, when: float) -> None:
        """Let the live scene be what it is at a time; solutions that were found before keep theirs."""
        before = self.live.snapshot()
        self.live.become(self.scene.at(when))
        before.forget()


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
