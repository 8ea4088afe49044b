"""When a robot that follows a path is where, among obstacles that move."""

from sinuous.checks import Floats
from sinuous.motion.times import even_times, with_start
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot


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
