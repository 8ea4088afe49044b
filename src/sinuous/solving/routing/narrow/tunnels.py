"""Tunnels: tubes in the middle of a route, which a chain is led through along their axes.

What is bent and narrow has no place where ends of segments must lie, but it says how they lie. So from a place of the
route within it the tube is followed both ways to its mouths. The part of the robot before it ends just beyond its
first mouth, what is in it is laid along its axis, and the rest goes on from where that ends.
"""

from bisect import bisect_right
from collections.abc import Iterator

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.fitting.query import ball_radius
from sinuous.kernels.tables import MAX_LENGTH
from sinuous.kernels.tubes.axis import BRANCH, MOUTH, follow_tube
from sinuous.solving.polylines import lengths_along, points_at, respaced
from sinuous.solving.routing.gates import NARROW, WIDE, Laid, Spot, Way, gate_row, run_about
from sinuous.solving.routing.growth import LEG_POINTS, segments_of
from sinuous.solving.routing.parts import lengths_of_first, segments_in
from sinuous.solving.routing.tubes import Distance
from sinuous.solving.routing.turned import Groups

POINTS = 1000
"""Most points of an axis, on either side."""

QUANTILE = 0.3
"""Of the distances of its axis from the walls, that of which a tunnel is at most `NARROW` times as wide."""

SHORTEST = 4.0
"""Length that a tunnel has at least, in radii of the body."""

INTO = 0.7
"""How far within a tunnel the part before it ends at least, in radii of the body."""

PLACES = ((0, 1.0, 0.0), (0, 0.0, 1.0), (1, 0.0, 0.5))
"""What is tried in turn: how many segments fewer are in a tunnel than it holds at their mean length; how far they are
stretched from there to fill it; and of what they leave of it, how much is before them."""

BARELY = 0.15
"""Of a segment, what may stick out of a tunnel and still count as in it."""

STRETCHED = 0.85
"""Of the length of a route, the least that a chain along it can have."""

TANGENT = 2
"""Points that directions of routes and axes are taken over."""


def tunnel_on(groups: Groups, legs: Floats, distances: Floats, distance: Distance, seconds: float) -> "Tunnel | None":
    """Return the tunnel about the narrowest point of the legs (l, K, 3) of a route; `None` where there is none.

    `distances` (l, K) are those of the legs.
    """
    radius = ball_radius(segments_in(groups[0]))
    which = int(distances.min(axis=1).argmin())
    if distances[which].min() > WIDE * radius:
        return None
    at = min(max(_middle(distances[which]), TANGENT), legs.shape[1] - 1 - TANGENT)
    ahead = legs[which, at + TANGENT] - legs[which, at - TANGENT]
    if not ahead.any():
        return None
    axis = _axis_at(groups[1], legs[which, at], ahead / np.linalg.norm(ahead), radius, seconds, distance)
    if len(axis) < 2 or lengths_along(axis)[-1] < SHORTEST * radius:
        return None
    tunnel = Tunnel(groups, legs, respaced(axis, max(8, len(axis))), radius)
    return tunnel if tunnel.places else None


def _middle(distances: Floats) -> int:
    """The middle of the places (K,) about the narrowest one that are as narrow: it may be at the rim of a mouth."""
    at = int(distances.argmin())
    return sum(run_about(distances <= NARROW * distances[at], at)) // 2


def _axis_at(scene: Floats, place: Floats, ahead: Floats, radius: float, seconds: float, distance: Distance) -> Floats:
    """The axis (K, 3) of the tube about a place, from the mouth behind it on; none (0, 3) where there is no tube.

    Only so far as it is narrow: rays may meet the walls of a room beyond a mouth, too.
    """
    halves = []
    for way in (-ahead, ahead):
        points, clock = np.empty((POINTS, 3)), np.zeros(CLOCK_SIZE, np.int64)
        count, ended = follow_tube(scene, np.stack([place, way]), (radius, radius, 0.0), seconds, clock, points)
        if ended not in (MOUTH, BRANCH):
            return np.empty((0, 3))
        halves.append(points[:count])
    axis = np.vstack([halves[0][:0:-1], halves[1]])
    distances = distance(axis)
    first, last = run_about(distances <= NARROW * np.quantile(distances, QUANTILE), len(halves[0]) - 1)
    return axis[first : last + 1]


class Tunnel:
    """A tube in the middle of a route.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    legs : ndarray (l, K, 3)
        The legs of a route, evenly spaced, in the length unit.
    axis : ndarray (k, 3)
        From the first mouth to the other, evenly spaced.
    radius : float
        Of the body.
    """

    def __init__(self, groups: Groups, legs: Floats, axis: Floats, radius: float) -> None:
        self._legs, self._axis, self._radius = legs, axis, radius
        self._segments, self._elbows = segments_in(groups[0]), segments_of(groups)[-len(legs) : -1]
        low, high = lengths_of_first(self._segments)
        self._lengths = low.tolist(), high.tolist(), (0.5 * (low + high)).tolist()
        self._along = lengths_along(axis)
        self._length = float(self._along[-1])
        points = legs.reshape(-1, 3)
        first, last = (int(np.linalg.norm(points - end, axis=1).argmin()) for end in (axis[0], axis[-1]))
        self._entry, self._exit = (divmod(at, legs.shape[1]) for at in (first, last))
        self.places = list(self._all(points, first, last)) if first < last else []

    def _all(self, points: Floats, first: int, last: int) -> Iterator[Spot]:
        """Yield a spot for each way of laying segments in it, with the numbers of segments that may be before it."""
        if not 0 < first < last < len(points) - 1:
            return
        gone = lengths_along(points)
        before, after = gone[first], gone[-1] - gone[last]
        (_, high, mean), n = self._lengths, len(self._segments)
        for place in range(len(PLACES)):
            counts, gaps = [], []
            for m in range(1, n):
                inside, depth, length = self._inside(place, m)
                end, more = m + inside, max(0.0, self._length - depth - length)
                if high[m] < STRETCHED * (before + depth) or high[-1] - high[end] < STRETCHED * (after + more):
                    continue
                if not self._fits(m, end):
                    continue
                counts.append(m)
                stowed = (mean[m] - before - depth) / m, (mean[-1] - mean[end] - after - more) / max(1, n - end)
                gaps.append(abs(stowed[0] - stowed[1]))
            if counts:
                yield Spot(place, counts, int(np.argmin(gaps)))

    def _fits(self, begin: int, end: int) -> bool:
        """Whether elbows before it, in it and beyond it are of segments that are."""
        for leg, segment in enumerate(self._elbows):
            if leg < self._entry[0]:
                least, most = 0, begin - 1  # the end of the last one before it is asked to be at its mouth
            elif leg < self._exit[0]:
                least, most = begin, end
            else:
                least, most = end, len(self._segments)
            if not least <= segment < most:
                return False
        return True

    def way(self, place: int, count: int) -> Way:
        """Return the way through the tunnel with so many segments before it."""
        inside, depth, length = self._inside(self.places[place].at, count)
        end = depth + length
        line = self._between(depth, end)
        legs, (leg, at) = self._legs, self._entry
        begun = np.vstack([legs[leg][: at + 1], self._axis[self._along < depth], line[0]])
        before = np.concatenate([legs[:leg], respaced(begun, LEG_POINTS)[None]])
        leg, at = self._exit
        ended = np.vstack([line[-1], self._axis[self._along > end], legs[leg][at:]])
        after = np.concatenate([respaced(ended, LEG_POINTS)[None], legs[leg + 1 :]])
        return Way([self._row(depth, count)], [before, after], Laid(inside, line))

    def _between(self, depth: float, end: float) -> Floats:
        """The axis (K, 3) between two depths; beyond its end it goes on straight."""
        first, last = points_at(self._axis, self._along, np.array([depth, min(end, self._length)]))
        inner = (self._along > depth) & (self._along < end)
        line = np.vstack([first, self._axis[inner], last])
        if end > self._length:
            ahead = self._axis[-1] - self._axis[-1 - TANGENT]
            line = np.vstack([line, last + (end - self._length) / np.linalg.norm(ahead) * ahead])
        return line

    def _row(self, depth: float, count: int) -> Floats:
        """The pose on the axis at a depth, as a target of the end of the first `count` segments."""
        place, ahead = points_at(self._axis, self._along, np.array([depth, depth + INTO * self._radius]))
        return gate_row(count, place, (ahead - place) / np.linalg.norm(ahead - place))

    def _inside(self, place: int, count: int) -> tuple[int, float, float]:
        """How many segments lie in it after so many, how deep they begin, and their length."""
        fewer, filled, slack = PLACES[place]
        (low, high, mean), longest = self._lengths, self._segments[count, MAX_LENGTH]
        room = self._length - INTO * self._radius
        held = bisect_right(mean, mean[count] + room + BARELY * longest, count) - 1 - count
        end = count + max(0, min(held, len(self._segments) - count - 1) - fewer)
        least, most, length = low[end] - low[count], high[end] - high[count], mean[end] - mean[count]
        inside, length = end - count, length + filled * (min(max(room, least), most) - length)
        depth = INTO * self._radius + slack * max(0.0, room - length)
        return inside, min(depth, self._length - INTO * self._radius), length
