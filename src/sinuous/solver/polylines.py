"""Lines through points, or through the knots of a motion: how long they are up to each, and what lies between."""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.fitting.lines import measure_line, respace_line


def lengths_along(line: Floats) -> Floats:
    """Return the length (K,) of a line (K, 3) up to each of its points."""
    along = np.empty(len(line))
    measure_line(np.array(line, order="C"), along)  # a copy, as in `respaced`
    return along


def points_at(line: Floats, along: Floats, wanted: Floats) -> Floats:
    """Return the points (M, 3) at lengths (M,) along a line (K, 3), whose own points are at `along` (K,)."""
    return np.stack([np.interp(wanted, along, column) for column in line.T], axis=-1)


def respaced(line: Floats, count: int) -> Floats:
    """Return so many points, two at least, that are evenly spaced along a line (K, 3)."""
    points = np.empty((count, 3))
    respace_line(np.array(line), points)  # a copy, because kernels are compiled for what can be written
    return points


def interpolate(times: Floats, q: Floats, when: Floats) -> Floats:
    """Return configurations (..., n, 3) at times (...) within those of the knots `q` (T, n, 3), linear between them."""
    if len(q) == 1:
        return np.broadcast_to(q[0], (*when.shape, *q.shape[1:])).copy()
    step = np.clip(np.searchsorted(times, when, side="right") - 1, 0, len(q) - 2)
    share = ((when - times[step]) / (times[step + 1] - times[step]))[..., None, None]
    return (1.0 - share) * q[step] + share * q[step + 1]
