"""Detours: routes that are led aside until they are as long as the robot, in many ways.

Where a body is longer than its route, some of it has to be stowed beside that. How much, and where, decides whether it
still gets through the next door, and chains that are grown along the shortest route choose it step by step. Along a
route that is as long as they are, they have nothing to choose.
"""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.fitting.query import ball_radius
from sinuous.kernels.growing.detours import LONG_ENOUGH, MOST_DETOURS, NUMBERS, add_detours, detours_size
from sinuous.kernels.tables import MAX_LENGTH, MIN_LENGTH
from sinuous.solver.polylines import lengths_along, respaced
from sinuous.solver.routing.growth import LEG_POINTS, segments_of
from sinuous.solver.routing.partial_problems import segments_in
from sinuous.solver.routing.reversed_problem import Groups
from sinuous.solver.starts import Deadline

POINTS = 64
"""Points of a leg that are looked at."""

GOLDEN = 0.618034
"""Share of what a leg may be longer by which one detour differs from the next."""


def lengthen_route(groups: Groups, legs: Floats, number: int, deadline: Deadline) -> Floats | None:
    """Return the legs (l, K, 3) of a route, each as long as some of its segments may be; `None`: none becomes longer.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    legs : ndarray (l, K, 3)
        Evenly spaced, in the length unit.
    number : int
        Of the detour: each leads somewhere else.
    deadline : callable
        See `Deadline`.
    """
    segments, rng = segments_in(groups[0]), np.random.default_rng(number)
    ends = [0, *(1 + last for last in segments_of(groups)[: len(legs)])]
    workspace, longer, some = np.empty(detours_size(POINTS)), legs.copy(), False
    for i, leg in enumerate(legs):
        own = segments[ends[i] : ends[i + 1]]
        least, most = own[:, MIN_LENGTH].sum(), own[:, MAX_LENGTH].sum()
        length = lengths_along(leg)[-1]
        least = max(least, length)
        wanted = least + ((1 + number) * GOLDEN % 1.0) * (most - least)
        if length < LONG_ENOUGH * wanted:
            points, numbers = respaced(leg, POINTS), rng.random((MOST_DETOURS, NUMBERS))
            left = max(0.0, deadline())
            if (
                add_detours(groups[1], wanted, ball_radius(segments), numbers, left, workspace, points)
                > length / LONG_ENOUGH
            ):
                longer[i], some = respaced(points, LEG_POINTS), True
    return longer if some else None
