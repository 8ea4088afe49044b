"""When the page is: from when to when there is something to see, and where obstacles are at a time."""

from sinuous.motion.job import Job
from sinuous.motion.motion import Motion
from sinuous.scene.snapshot import Snapshot


class Moments:
    """The obstacles at one time after the other; what is asked for again is the same object."""

    def __init__(self) -> None:
        self._known: tuple[Snapshot, float, Snapshot] | None = None

    def at(self, scene: Snapshot, time: float) -> Snapshot:
        """Return the obstacles as they are at a time; itself where none moves."""
        if not scene.moves:
            return scene
        if self._known is None or self._known[0] is not scene or self._known[1] != time:
            self._known = scene, time, scene.at(time)
        return self._known[2]


def window_of(job: Job, motion: Motion | None) -> tuple[float, float]:
    """Return the first and the last time of a motion, or else of all obstacles that move and of the waypoints.

    Motions begin at 0, unless somebody says otherwise; so that time is among them.
    """
    if motion is not None:
        return float(motion.times[0]), float(motion.times[-1])
    courses = job.scene.snapshot().courses.values()
    if not courses:
        return 0.0, 0.0
    ends = [0.0, *(float(time) for course in courses for time in (course.times[0], course.times[-1]))]
    if job.is_path:
        ends += [time_of(job, 0), time_of(job, len(job.waypoints) - 1)]
    return min(ends), max(ends)


def time_of(job: Job, waypoint: int) -> float:
    """Return when a path is at a waypoint, 0 = first: at 0, 1, 2, ... with the start, unless they have times."""
    return float(waypoint + (job.start is not None)) if job.times is None else float(job.times[waypoint])
