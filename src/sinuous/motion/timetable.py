"""Times of a motion: those of its knots, and of the waypoints of a path."""

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.motion.configurations import distances
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot


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
        The scene as it is at the time that was set last.
    """

    def __init__(self, scene: Snapshot, times: Floats | None, waypoints: int, started: bool) -> None:
        given = np.arange(float(waypoints + started))[started:] if times is None else times
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

    def set_time(self, when: float) -> None:
        """Let the live scene be what it is at a time; solutions that were found before keep theirs."""
        before = self.live.snapshot()
        self.live.become(self.scene.at(when))
        before.forget()
