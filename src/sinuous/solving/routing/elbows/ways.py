"""Ways of a robot through a tube that its elbow lies in: in by one mouth, out by the other.

A route to the elbow, and one from there to the tip, are searched for without knowing of each other: they enter by the
nearer mouth, and may turn round in the tube. A body goes on as it came. So the tube is followed from the elbow both
ways, and is passed in either direction: the segments that it holds before the elbow, and those that it holds behind
it, are given by its length.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import FREE, HAS_POSITION, MAX_LENGTH, MIN_LENGTH, ORIENTATION
from sinuous.solving.polylines import lengths_along, respaced
from sinuous.solving.routing.elbows.inside import Inside
from sinuous.solving.routing.gates import Way, gate_row
from sinuous.solving.routing.growth import LEG_POINTS, arriving, departing, segments_of
from sinuous.solving.routing.parts import segments_in
from sinuous.solving.routing.tubes import lengthened
from sinuous.solving.routing.turned import Groups

VARIANTS = ((0.5, 0, 0), (0.5, 1, 0), (0.0, 0, 0), (0.9, 0, 0), (0.5, 0, 1))
"""What is tried in turn: how long segments in the tube are, between their least and their greatest length; and how many
fewer are in it than it holds, before the elbow and behind it."""

BEYOND = 0.15
"""How far beyond a mouth what lies in the tube may end, in lengths of a segment."""

CUT = 0.8
"""Of a route, the least length of a body that goes the same way: it cuts corners, where the route keeps to cells."""

TOO_FEW = 3
"""Segments that may be too few to come to an elbow in just one direction."""

Route = Callable[[Floats], Floats | None]
"""From what a route has to keep (28,) to a route (K, 3), where one is found."""


class Held(NamedTuple):
    """What a tube holds on one side of the elbow.

    Attributes
    ----------
    segments : int
        How many it holds.
    line : ndarray (K, 3)
        The axis from the elbow to where the last of them ends; two points alike, where there are none.
    ahead : ndarray (3,)
        Unit tangent there, away from the elbow.
    """

    segments: int
    line: Floats
    ahead: Floats


class Ways:
    """Ways through the tube that the elbow lies in.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`: two targets have a position.
    queries : list of ndarray (28,)
        What routes have to keep to the elbow, and from there to the tip.
    tube : Inside
    route : callable
    """

    def __init__(self, groups: Groups, queries: list[Floats], tube: Inside, route: Route) -> None:
        self._segments = segments_in(groups[0])
        self._elbow, self._last = (segment + 1 for segment in segments_of(groups))
        self._queries, self._tube, self._route = queries, tube, route
        self._routes: dict[bytes, Floats | None] = {}

    def __iter__(self) -> Iterator[Way]:
        """Yield the ways, those that are likelier first; routes are searched for as they are needed."""
        tried = set()
        low, high = self._segments[:, MIN_LENGTH], self._segments[:, MAX_LENGTH]
        for share, fewer_before, fewer_behind in VARIANTS:
            own = low + share * (high - low)
            for which, inside in enumerate((self._tube, self._tube.turned())):
                before = _held(inside.one, -inside.along, own[: self._elbow][::-1], fewer_before)
                behind = _held(inside.other, inside.along, own[self._elbow : self._last], fewer_behind)
                key = which, before.segments, behind.segments, *before.line[-1], *behind.line[-1]
                way = None if key in tried else self._way(before, behind, inside.along)
                tried.add(key)
                if way is not None:
                    few = before.segments == 0 and self._elbow <= TOO_FEW
                    yield from (way, _undirected(way)) if few else (way,)

    def _way(self, before: Held, behind: Held, along: Floats) -> Way | None:
        """The way through what a tube holds; `None` where no route leads there, or no chain is that long."""
        first, last = self._elbow - before.segments, self._elbow + behind.segments
        to = self._approach(before.line[-1], -before.ahead)
        off = None if to is None else self._leaving(behind.line[-1], behind.ahead)
        if to is None or off is None:
            return None
        longest = self._segments[:, MAX_LENGTH]
        for route, own in ((to, longest[:first]), (off, longest[last : self._last])):
            if CUT * lengths_along(route)[-1] > own.sum():
                return None
        elbow = gate_row(self._elbow, before.line[0], along)
        elbow[HAS_POSITION] = 0.0  # its own target says where it is
        rows, legs = [elbow], [to, off]
        if before.segments > 0:
            rows.insert(0, gate_row(first, before.line[-1], -before.ahead))
            legs.insert(1, before.line[::-1])
        if behind.segments > 0:
            rows.append(gate_row(last, behind.line[-1], behind.ahead))
            legs.insert(-1, behind.line)
        return Way(rows, [respaced(leg, LEG_POINTS)[None] for leg in legs])

    def _approach(self, place: Floats, along: Floats) -> Floats | None:
        query = self._queries[0].copy()
        arriving(query, place, along)
        return self._found(query)

    def _leaving(self, place: Floats, along: Floats) -> Floats | None:
        query = self._queries[1].copy()
        departing(query, place, along)
        return self._found(query)

    def _found(self, query: Floats) -> Floats | None:
        key = query.tobytes()
        if key not in self._routes:
            self._routes[key] = self._route(query)
        return self._routes[key]


def _held(axis: Floats, ahead: Floats, own: Floats, fewer: int) -> Held:
    """What a tube holds of segments of these lengths, from the elbow on along its axis (K, 3); or some fewer."""
    ends, length = np.cumsum(own), lengths_along(axis)[-1]
    count = int(np.searchsorted(ends, length + BEYOND * own.mean(), side="right")) - fewer
    count = min(max(0, count), len(own) - 1)
    if count == 0 or length == 0.0:
        return Held(0, np.stack([axis[0], axis[0]]), ahead)
    line = lengthened(axis, ends[count - 1])
    tangent = line[-1] - line[-2]
    return Held(count, line, tangent / np.linalg.norm(tangent))


def _undirected(way: Way) -> Way:
    """The same way, but from any direction to its first row, which is the elbow."""
    rows = [row.copy() for row in way.rows]
    rows[0][ORIENTATION] = FREE
    return Way(rows, way.legs)
