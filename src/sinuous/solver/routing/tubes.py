"""Starts for a base that lies in a tube: the chain is laid along its axis, and what is left of it goes on from there.

What lies in a tube is said by the tube. What is left is a shorter robot, that stands where the tube opens: mostly an
easy question. A route to the target is of no use for it: it bends around the rim, and a chain that is much longer than
the route is drawn together in the tube, too.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.tubes import BRANCH, MOUTH, WALL, follow_tube
from sinuous.solver.polylines import lengths_along, points_at, respaced
from sinuous.solver.routing.partial_problems import (
    backbone_of,
    first_segments,
    fit_chain,
    problem_beyond,
    search_part,
    segments_in,
)
from sinuous.solver.routing.reversed_problem import Groups
from sinuous.solver.starts import Deadline

POINTS = 1000
"""Most points of an axis."""

SHORTEST = 3.0
"""Length that a tube has at least."""

BESIDE = 2.5
"""How far from the axis a target in a tube is at most. In radii of the body."""

FINER = 0.4
"""Of the first steps, those by which a tube is followed again that ends at a wall."""

BARELY = 0.15
"""Of a segment, what may stick out of the tube and still count as in it."""

AHEAD = 2
"""Points of the axis that its direction at the mouth is taken over."""

STARTS = 6
"""Own starts of what is left of the chain, the first of which is the single arc."""

Distance = Callable[[Floats], Floats]
"""From points (m, 3) to their distances from the obstacles (m,), in the length unit."""


class Tube(NamedTuple):
    """A tube that the base lies in.

    Attributes
    ----------
    axis : ndarray (K, 3)
        Points, evenly spaced but for the first step, from the base on.
    ended : int
        Where it ends: MOUTH, END or BRANCH of `sinuous.kernels.tubes`.
    """

    axis: Floats
    ended: int

    @property
    def open(self) -> bool:
        """Whether it ends at a mouth."""
        return self.ended == MOUTH


def find_tube_around(scene: Floats, query: Floats, seconds: float) -> Tube | None:
    """Return the tube that the base lies in, from what a route has to keep (27,); `None` where there is none."""
    radius, longest = query[t.QUERY_RADIUS], query[t.QUERY_LONGEST]
    if radius <= 0.0:
        return None
    spacing = max(radius, longest / POINTS)
    tube = _followed(scene, query, spacing, seconds)
    if tube is not None and tube.ended == WALL and line_to_target_in_tube(tube, query) is None:
        tube = _followed(scene, query, FINER * spacing, seconds)  # it may bend too much for the first steps
    return tube


def _followed(scene: Floats, query: Floats, spacing: float, seconds: float) -> Tube | None:
    radius = query[t.QUERY_RADIUS]
    origin, axis = (query[at : at + 3] for at in (t.QUERY_ORIGIN, t.QUERY_AXIS))
    points, clock = np.empty((2 * POINTS, 3)), np.zeros(CLOCK_SIZE, np.int64)
    sizes = radius, spacing, query[t.QUERY_FREE_LENGTH]
    count, ended = follow_tube(scene, np.stack([origin, axis]), sizes, seconds, clock, points)
    known = points[:count]
    if ended not in (MOUTH, WALL, BRANCH) or lengths_along(known)[-1] < SHORTEST * radius:
        return None
    return Tube(known, ended)


def line_to_target_in_tube(tube: Tube, query: Floats) -> Floats | None:
    """Return the line (K, 3) along the axis to a target that lies in the tube; `None` where it does not."""
    goal = query[t.QUERY_GOAL : t.QUERY_GOAL + 3]
    gaps = np.linalg.norm(tube.axis - goal, axis=1)
    at = int(gaps.argmin())
    last = len(tube.axis) - 1
    if gaps[at] > BESIDE * query[t.QUERY_RADIUS] or at < 2 or (tube.open and at == last):
        return None
    return _spaced(np.vstack([tube.axis[:at], goal]))


def chains_out_of_tube(tube: Tube, groups: Groups, deadline: Deadline) -> Iterator[tuple[Floats, Floats]]:
    """Yield chains (n, 3) that lead out of a tube, and the routes (K, 3) along which they lie."""
    for head, line in chains_in_tube(tube, groups, deadline):
        yield _joined(groups, head, line, deadline)


def chains_in_tube(tube: Tube, groups: Groups, deadline: Deadline) -> Iterator[tuple[Floats, Floats]]:
    """Yield chains (m, 3) of the segments that a tube holds, and the lines (K, 3) along which they lie.

    First with the one that it holds only in part, then without.
    """
    robot, scene, settings, targets = groups
    n, segments = int(groups[0][0]), segments_in(groups[0])
    ends = np.cumsum(segments[:, [t.MIN_LENGTH, t.MAX_LENGTH]].mean(axis=1))
    length = lengths_along(tube.axis)[-1] - BARELY * segments[-1, t.MAX_LENGTH]
    inside = 1 + int(np.searchsorted(ends, length))
    for count in (inside, inside - 1) if inside <= n else ():
        if 0 < count < n and deadline() > 0.0:
            line = lengthen_axis(tube.axis, ends[count - 1])
            yield (
                fit_chain((first_segments(robot, count), scene, settings, targets[:0]), line, max(0.0, deadline())),
                line,
            )


def _joined(groups: Groups, head: Floats, line: Floats, deadline: Deadline) -> tuple[Floats, Floats]:
    """A chain that begins with segments (m, 3) along a line (K, 3), and goes from there to the targets; its route."""
    rest = problem_beyond(groups, head)
    q = search_part(rest, np.empty((0, int(rest[0][0]), 3)), (0, STARTS), deadline).q
    return np.concatenate([head, q]), np.concatenate([line[:-1], backbone_of(rest, q)])


def lengthen_axis(axis: Floats, length: float) -> Floats:
    """The axis (K, 3) made so long: cut, or gone on straight."""
    along = lengths_along(axis)
    inside = axis[along < length]
    if length <= along[-1]:
        end = points_at(axis, along, np.array([length]))[0]
    else:
        ahead = axis[-1] - axis[max(0, len(axis) - 1 - AHEAD)]
        end = axis[-1] + (length - along[-1]) / np.linalg.norm(ahead) * ahead
    return _spaced(np.vstack([inside, end]))


def _spaced(line: Floats) -> Floats:
    """As many points, or a few at least, evenly spaced along a line (K, 3)."""
    return respaced(line, max(8, len(line)))
