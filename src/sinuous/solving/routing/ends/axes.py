"""The tube that the end of a route lies in, followed from there to where it opens."""

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import QUERY_BACK, QUERY_GOAL, QUERY_ORIGIN, QUERY_RADIUS
from sinuous.kernels.tubes.axis import END
from sinuous.solving.routing.growth import departing
from sinuous.solving.routing.tubes import Distance, axis_direction, in_the_open, tube_around

NEAR = 2.5
"""How far two axes are from each other at most that meet, in radii of the body."""


def axes_from_goal(scene: Floats, query: Floats, distance: Distance, seconds: float) -> list[Floats]:
    """Return the axes (K, 3) of the tube that the goal of a route lies in, from there to its mouths, or to a branch.

    `query` (28,) is what the route has to keep. Where it has to arrive along a direction, there is but one axis, that
    comes from there. An axis that leads past the beginning of the route ends there.
    """
    radius, goal = float(query[QUERY_RADIUS]), query[QUERY_GOAL : QUERY_GOAL + 3]
    if in_the_open(goal, radius, distance):
        return []
    back, origin = query[QUERY_BACK : QUERY_BACK + 3], query[QUERY_ORIGIN : QUERY_ORIGIN + 3]
    along = back if back.any() else axis_direction(goal, radius, distance)
    axes = []
    for ahead in (along,) if back.any() else (along, -along):
        asked = query.copy()
        departing(asked, goal, ahead)
        tube = tube_around(scene, asked, seconds)
        if tube is None:
            continue
        gaps = np.linalg.norm(tube.axis - origin, axis=1)
        if gaps.min() < NEAR * radius:
            axes.append(tube.axis[: max(2, int(gaps.argmin()))])
        elif tube.ended != END:
            axes.append(tube.axis)
    return axes


def joined(first: Floats, axis: Floats, near: float) -> Floats | None:
    """Return the line (K, 3) along one axis (k, 3), and back along another one to its beginning, where they meet."""
    gaps = np.linalg.norm(first[:, None] - axis, axis=-1)
    i, j = np.unravel_index(gaps.argmin(), gaps.shape)
    return None if gaps[i, j] > near or j == 0 else np.vstack([first[: i + 1], axis[:j][::-1]])
