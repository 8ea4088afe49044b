"""Lines through points: how long they are up to each of them, and other points along them."""

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
