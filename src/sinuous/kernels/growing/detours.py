"""Detours: a route is led aside, once or more often, until it is as long as the chain that is to lie along it.

A route is about the shortest way. A longer body has to be stowed beside it, and where it has room for that the route
does not say: a chain that spends its length as it goes seldom ends up where it can still get through the next door.
"""

import math

from sinuous.kernels.clock import CLOCK_SIZE, begin_for, spend
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import closest, read_scene, work_of_all
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.freespace.band import respace
from sinuous.kernels.growing.guide import SIGHT_EVALUATIONS, Guide, sees_point
from sinuous.kernels.maths.buffers import cut, cut_whole
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, add_scaled, copy, get_vec, norm, put_vec, sub

MOST_DETOURS, NUMBERS = 32, 4
"""Most places that a route is led to, and the random numbers that each of them takes."""

LONG_ENOUGH = 0.97
"""Share of the wanted length from which on a route is long enough."""

FARTHEST, NEAREST = 0.7, 0.15
"""How far from the route such a place is, in units of the length that is missing."""

PLACE_CLEARANCE = 1.5
"""Its least distance from the obstacles, in radii of the body."""

WORTH = 0.2
"""Least length that a detour by one place adds, in units of the length that is missing."""


def detours_size(count: int) -> int:
    """Numbers (float64) that a route of so many points is led aside in."""
    return CLOCK_SIZE + count + 3 * (count + 1)


def _draw_place_aside(guide: Guide, numbers: Array, missing: float) -> Vec:
    """Return a place beside the guide, given random numbers (4,) from 0 to 1."""
    at = get_vec(guide.points, int(numbers[0] * guide.points.shape[0]), 0)
    height, turn = 2.0 * numbers[1] - 1.0, 2.0 * math.pi * numbers[2]
    level = math.sqrt(1.0 - height * height)
    off = (NEAREST + numbers[3] * (FARTHEST - NEAREST)) * missing
    return add_scaled(at, off, (level * math.cos(turn), level * math.sin(turn), height))


def _find_longest_detour(guide: Guide, away: Array, missing: float) -> tuple[int, int]:
    """Points between which a detour adds most, but no more than is missing; (0, 0): there is none.

    `away` (K,) are the distances of the points from the place that it leads by, infinite where they do not see it.
    """
    most, first, last = WORTH * missing, 0, 0
    for i in range(away.shape[0]):
        if away[i] < math.inf:
            for j in range(i + 1, away.shape[0]):
                longer = away[i] + away[j] - (j - i) * guide.spacing
                if most < longer <= missing:
                    most, first, last = longer, i, j
    return first, last


@entry
def add_detours(
    scene: Array, wanted: float, radius: float, numbers: Array, seconds: float, workspace: Array, points: Array
) -> float:
    """Lead a route aside until it is as long as wanted, nearly; return its length.

    Parameters
    ----------
    scene : ndarray
        Group, laid out as `sinuous.kernels.tables` says.
    wanted : float
        Length, in the length unit.
    radius : float
        Of the body, in the length unit.
    numbers : ndarray (MOST_DETOURS, NUMBERS)
        Random, from 0 to 1.
    seconds : float
        Budget.
    workspace : ndarray (w,)
        Scratch, see `detours_size`.
    points : ndarray (K, 3)
        The route, evenly spaced, in the length unit: it is changed.
    """
    obstacles, count = read_scene(scene), points.shape[0]
    clock, rest = cut_whole(workspace, CLOCK_SIZE)
    away, rest = cut(rest, count)
    line, _ = cut(rest, count + 1, 3)
    begin_for(clock, seconds)
    copy(points, line)
    spacing = respace(line, count, points, count)
    units = SIGHT_EVALUATIONS * work_of_all(obstacles)
    for turn in range(MOST_DETOURS):
        length = spacing * (count - 1)
        if length >= LONG_ENOUGH * wanted or spend(clock, units):
            break
        guide = Guide(points, spacing, ZERO, radius, 0.0)
        place = _draw_place_aside(guide, numbers[turn], wanted - length)
        if closest(obstacles, place, PLACE_CLEARANCE * radius, INTERPOLATED)[0] < PLACE_CLEARANCE * radius:
            continue
        for i in range(count):
            away[i] = norm(sub(place, get_vec(points, i, 0)))
            if spend(clock, units) or not sees_point(obstacles, guide, place, i):
                away[i] = math.inf
        first, last = _find_longest_detour(guide, away, wanted - length)
        if last > first:
            copy(points[: first + 1], line)
            put_vec(line, first + 1, 0, place)
            copy(points[last:], line[first + 2 :])
            spacing = respace(line, first + 2 + count - last, points, count)
    return float(spacing * (count - 1))
