"""When a robot is at the knots of a motion, where nobody said it."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.robot.robot import Robot
from sinuous.robot.segment import Segment

KEPT = 64
"""Robots whose levers are kept."""


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


def distances(robot: Robot, q: Floats) -> Floats:
    """Return how far neighbouring configurations (T, n, 3) are apart (T - 1,), in the length unit.

    A change of a bend counts by the length of what it moves, from the middle of its segment to the tip, at mean
    lengths; a change of a length by itself.
    """
    steps = (q[1:] - q[:-1]) * lever_metric(robot)
    result: Floats = np.sqrt(np.einsum("tnk,tnk->t", steps, steps))
    return result


def lever_metric(robot: Robot) -> Floats:
    """Return by how much changes of bends and lengths (n, 3) count in a distance; see `distances`."""
    return _levers_of(robot.segments)


@lru_cache(maxsize=KEPT)
def _levers_of(segments: tuple[Segment, ...]) -> Floats:
    lengths = np.array([0.5 * (segment.length[0] + segment.length[1]) for segment in segments])
    levers = np.cumsum(lengths[::-1])[::-1] - 0.5 * lengths
    result = np.stack([levers, levers, np.ones(len(levers))], axis=-1)
    result.flags.writeable = False
    return result
