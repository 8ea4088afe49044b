"""Routes through tubes that open beside edges: from the base to a mouth, along an axis, and on from the other mouth.

A search over cells fills both rooms that a tube joins before it finds the mouths. Their rims say where they are.
"""

import heapq
import itertools
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.tubes import find_tubes
from sinuous.solver.polylines import lengths_along, respaced
from sinuous.solver.routing.growth import set_route_end, set_route_start

TUBES, POINTS = 16, 4096
"""Most tubes, and most points of all their axes."""

LEGS = 8
"""Most legs of routes, from mouth to mouth, that are searched for."""

DRAWN = 0.9
"""What is left at least of the length of a route when it is drawn tight."""

FEWEST = 256
"""Points of a route at least."""

AHEAD = 2
"""Points of an axis that its direction at a mouth is taken over."""

ORIGIN, GOAL = (slice(at, at + 3) for at in (t.QUERY_ORIGIN, t.QUERY_GOAL))

Leg = Callable[[Floats], Floats | None]
"""From what a route has to keep (27,) to a route (K, 3), or to none."""


def tubes_beside(scene: Floats, edges: Floats, radius: float, seconds: float) -> list[Floats]:
    """Return the axes (K, 3) of tubes, open at both ends, that open beside edges of boxes, or of meshes (e, 10)."""
    if radius <= 0.0:
        return []
    points, ends = np.empty((POINTS, 3)), np.zeros((TUBES, 3), np.int64)
    count = find_tubes(scene, edges, radius, seconds, np.zeros(CLOCK_SIZE, np.int64), points, ends)
    return [points[first:last].copy() for first, last, through in ends[:count] if through]


class _Path(NamedTuple):
    """A way from the origin through some tubes to the mouth of the next one, the last leg of which is not known yet.

    Attributes
    ----------
    bound : float
        Length of a route by it, at least.
    number : int
        Its own.
    gone : float
        Length up to the last mouth.
    lines : tuple of ndarray (K, 3)
        Legs and axes up to there.
    passed : tuple of int
        The tubes that they lead through.
    tube : int
        The next one; -1: the goal is next.
    axis : ndarray (K, 3)
        Its axis, from the mouth on that is next.
    """

    bound: float
    number: int
    gone: float
    lines: tuple[Floats, ...]
    passed: tuple[int, ...]
    tube: int
    axis: Floats


def route_through(axes: list[Floats], query: Floats, leg: Leg, last: Leg, most: int) -> Floats | None:
    """Return a route (K, 3) through tubes of these axes (K, 3), of at most so many points; `None` where none is found.

    Legs from mouth to mouth are searched for when they are needed, the most promising first; `last` those to the goal.
    """
    paths: list[_Path] = []
    numbers = itertools.count()
    _add_from(paths, numbers, axes, query, 0.0, (), ())
    for _ in range(LEGS):
        if not paths:
            return None
        path = heapq.heappop(paths)
        line = (leg if path.tube >= 0 else last)(_asked(query, path))
        if line is None:
            continue
        lines = (*path.lines, line, path.axis) if path.tube >= 0 else (*path.lines, line)
        if path.tube < 0:
            route = np.concatenate([lines[0], *(line[1:] for line in lines[1:])])
            length = lengths_along(route)[-1]
            return respaced(route, min(most, max(FEWEST, int(length / query[t.QUERY_RADIUS]))))
        gone = path.gone + lengths_along(line)[-1] + lengths_along(path.axis)[-1]
        _add_from(paths, numbers, axes, query, gone, lines, (*path.passed, path.tube))
    return None


def _add_from(
    paths: list[_Path],
    numbers: Iterator[int],
    axes: list[Floats],
    query: Floats,
    gone: float,
    lines: tuple[Floats, ...],
    passed: tuple[int, ...],
) -> None:
    """Note the paths that go on from the end of the last of some lines: through another tube, or to the goal."""
    end, goal = (lines[-1][-1] if lines else query[ORIGIN]), query[GOAL]
    new = [(-1, goal[None])] if lines else []
    new += [(i, axis[::way]) for i, axis in enumerate(axes) if i not in passed for way in (1, -1)]
    for tube, axis in new:
        rest = np.linalg.norm(axis[0] - end) + lengths_along(axis)[-1] + np.linalg.norm(goal - axis[-1])
        bound = float(gone + rest)
        if DRAWN * bound <= query[t.QUERY_LONGEST]:
            heapq.heappush(paths, _Path(bound, next(numbers), gone, lines, passed, tube, axis))


def _asked(query: Floats, path: _Path) -> Floats:
    """What the next leg of a path has to keep (27,)."""
    asked = query.copy()
    if path.lines:
        last = path.lines[-1]
        set_route_start(asked, last[-1], _unit(last[-1] - last[-1 - AHEAD]))
    if path.tube >= 0:
        set_route_end(asked, path.axis[0], _unit(path.axis[AHEAD] - path.axis[0]))
        asked[t.QUERY_GOAL_RADIUS] = 0.0
        to_mouth = np.linalg.norm(path.axis[0] - asked[ORIGIN])
        asked[t.QUERY_OTHER_LENGTH] = max(0.0, asked[t.QUERY_OTHER_LENGTH] - (path.bound - path.gone - to_mouth))
    asked[t.QUERY_LONGEST] -= path.gone
    return asked


def _unit(vector: Floats) -> Floats:
    return vector / max(np.linalg.norm(vector), np.finfo(float).tiny)
