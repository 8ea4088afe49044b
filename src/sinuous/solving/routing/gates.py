"""Gates: poses in the narrowest places of a route, which a chain is led through.

A chain that comes to a narrow place at a slant is lost there, and what leads into it straight is one chain among many.
So the end of one of its segments is asked to lie in that place, along the route, as if it were an elbow.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.kernels.fitting.query import ball_radius
from sinuous.kernels.tables import (
    DIRECTION,
    GOAL,
    HAS_POSITION,
    MAX_LENGTH,
    ORIENTATION,
    TARGET_POSITION,
    TARGET_SEGMENT,
    TARGET_WIDTH,
)
from sinuous.solving.polylines import respaced
from sinuous.solving.routing.growth import LEG_POINTS, segments_of
from sinuous.solving.routing.parts import lengths_of_first, segments_in
from sinuous.solving.routing.turned import Groups

NARROW, WIDE = 1.35, 3.0
"""Up to so many times the least distance a place is as narrow as the narrowest one; and distance, in radii of the body,
from which on no place is narrow."""

FAR = NARROW * WIDE
"""Distance from the obstacles, in radii of the body, beyond which nothing matters here."""

ALIKE = 0.06
"""How much distances of a channel from its walls differ, of their median."""

SHIFTS, INWARDS = (0.0, -0.5, 0.5), (0.0, 0.33, 0.67)
"""How far beyond a narrow place the gate lies, in lengths of a segment; and how far beyond where one begins that is
longer than a segment."""

BEGUN, ENDED = 0.7, (0.5, 1.5, 2.5)
"""How far within a long narrow place the gate lies where it begins, and where it ends: for each place of the first, in
units of its room. A route cuts the corner there, so it is not known well where the walls end."""

STRETCHED = 0.95
"""Of the length of a route, the least that a chain along it can have."""

SHARES = (0.5, 0.0, 0.9)
"""How long segments in a narrow place are, between their least and their greatest length: for each place."""

TAUT = 0.9998
"""Length that segments in a narrow place span at most, of their own."""

BEYOND = (0.3, 0.0, 0.15)
"""How far beyond the end of a narrow place what lies in it may end, in lengths of a segment: for each place."""

TANGENT = 3
"""Points on either side that the tangent of a route is taken over; where a long narrow place begins, those in it."""

ENDS = 0.04
"""Of a leg, what is not looked at, at its ends."""


class Laid(NamedTuple):
    """Segments that are laid along a line.

    Attributes
    ----------
    segments : int
        How many.
    line : ndarray (K, 3)
        From where they begin.
    """

    segments: int
    line: Floats


class Way(NamedTuple):
    """A way through a passage: poses that the ends of segments are to have, and the route between them.

    Attributes
    ----------
    rows : list of ndarray (15,)
        The poses as targets: one; or two, where a long narrow place begins and where it ends.
    legs : list of ndarray (l, K, 3)
        The legs of the route up to the first pose, from there to the next one, and from the last to its end.
    laid : Laid or None
        What lies along a line from the only pose on; the last legs lead on from where that ends.
    """

    rows: list[Floats]
    legs: list[Floats]
    laid: Laid | None = None


class Spot(NamedTuple):
    """Where gates are.

    Attributes
    ----------
    at : int
        At which point of the leg.
    counts : list of int
        How many segments of the leg may be before them: from the fewest on.
    even : int
        Which of these leave either part as much length to be stowed, for each of its segments.
    """

    at: int
    counts: list[int]
    even: int


class Passage:
    """The narrowest place of the legs of a route, and the gates there.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    legs : ndarray (l, K, 3)
        The legs of a route, evenly spaced, in the length unit.
    distances : ndarray (l, K)
        Of these points from the obstacles, in the length unit, or the most that there is beside them, across the route:
        from `WIDE` radii on anything that is not less.
    """

    def __init__(self, groups: Groups, legs: Floats, distances: Floats) -> None:
        segments = segments_in(groups[0])
        skipped = _skipped(legs.shape[1])
        looked = distances[:, skipped:-skipped]
        self._legs, self._skipped = legs, skipped
        self._which = int(looked.min(axis=1).argmin())
        ends = [-1, *segments_of(groups)[-len(legs) :]]
        self._first = ends[self._which] + 1
        self._own = segments[self._first : ends[self._which + 1] + 1]
        self._length = float(np.linalg.norm(np.diff(legs[self._which], axis=0), axis=1).max())  # corners are cut
        self._narrow = float(looked[self._which].min())
        self.room = self._narrow / ball_radius(segments)
        self._stretch = _stretch(looked[self._which], skipped)
        mean = self._own[:, MAX_LENGTH].mean()
        self._inwards = bool((self._stretch[1] - self._stretch[0]) * self._length > mean)
        self.places = list(self._all()) if self.room < WIDE else []

    def way(self, place: int, count: int) -> Way:
        """Return the way through the gate at a place with so many segments of the leg before it."""
        at, leg = self.places[place].at, self._legs[self._which]
        rows, cuts = [self._row(at, count, 0 if self._inwards else TANGENT, TANGENT)], [0, at]
        through, gone = self._through(place, count) if self._inwards else (0, 0.0)
        end = min(at + round(gone / self._length), self._stretch[1])
        if end > at and 0 < through < len(self._own) - count:
            rows.append(self._row(end, count + through, TANGENT, 0, at + gone / self._length - end))
            cuts.append(end)
        parts = [respaced(leg[a : b + 1], LEG_POINTS)[None] for a, b in pairwise([*cuts, len(leg) - 1])]
        parts[0] = np.concatenate([self._legs[: self._which], parts[0]])
        parts[-1] = np.concatenate([parts[-1], self._legs[self._which + 1 :]])
        return Way(rows, parts)

    def _through(self, place: int, count: int) -> tuple[int, float]:
        """How many segments lie between a gate and the end of the narrow place, and how far from the gate they end."""
        room = self._length * (self._stretch[1] - self.places[place].at) - ENDED[place] * self._narrow
        low, high = lengths_of_first(self._own[count:])
        own, more = low + SHARES[place] * (high - low), BEYOND[place] * high[-1] / len(high)
        through = max(0, int(np.searchsorted(own, room + more, side="right")) - 1)
        return through, float(min(max(room, TAUT * low[through]), TAUT * high[through]))

    def _row(self, at: int, count: int, back: int, ahead: int, more: float = 0.0) -> Floats:
        """The pose at a point of the leg, or more points ahead, as a target, after so many of its segments."""
        leg = self._legs[self._which]
        tangent = leg[at + ahead] - leg[at - back]
        place = leg[at] + more / (back + ahead) * tangent
        return gate_row(self._first + count, place, tangent / np.linalg.norm(tangent))

    def _all(self) -> Iterator[Spot]:
        """Yield where gates are, the most promising first."""
        low, high = lengths_of_first(self._own)
        mean, n, last = high[-1] / len(self._own), len(self._own), self._legs.shape[1] - 1
        begin, end = self._stretch
        if begin <= self._skipped or end >= last - self._skipped:
            return  # an end lies in it: chains are in there, or get there, without a gate
        first = begin + round(BEGUN * self._narrow / self._length) if self._inwards else (begin + end) // 2
        for shift in INWARDS if self._inwards else SHIFTS:
            at = first + round(shift * mean / self._length)
            if not TANGENT < at < last - TANGENT:
                continue
            before, after = STRETCHED * self._length * at, STRETCHED * self._length * (last - at)
            counts = [m for m in range(1, n) if high[m] >= before and high[-1] - high[m] >= after]
            if counts:
                stowed = [max(0.0, low[m] - before) / m - max(0.0, low[-1] - low[m] - after) / (n - m) for m in counts]
                yield Spot(at, counts, int(np.abs(stowed).argmin()))


def least_room(groups: Groups, distances: Floats) -> float:
    """Return the least of the distances (l, K) of legs from the obstacles, but for their ends, in radii of the body."""
    skipped = _skipped(distances.shape[1])
    return float(distances[:, skipped:-skipped].min()) / ball_radius(segments_in(groups[0]))


def _skipped(points: int) -> int:
    """How many points at either end of a leg are not looked at."""
    return max(1 + TANGENT, round(ENDS * points))


def _stretch(distances: Floats, skipped: int) -> tuple[int, int]:
    """First and last point of the narrow place around the narrowest point.

    A route that leads out of a channel cuts the corner of its mouth, so the narrowest point may be there. The walls of
    the channel are where distances are all alike.
    """
    at = int(distances.argmin())
    first, last = run_about(distances <= NARROW * max(0.0, distances[at]), at)
    middle = np.sort(distances[first : last + 1])[(last - first) // 2]
    alike = np.abs(distances - middle) <= ALIKE * abs(middle)
    alike[:first] = alike[last + 1 :] = False
    ends = np.flatnonzero(np.diff(np.concatenate([[False], alike, [False]])))
    first, last = max(zip(ends[::2], ends[1::2] - 1, strict=True), key=lambda run: run[1] - run[0])
    return int(first) + skipped, int(last) + skipped


def gate_row(count: int, place: Floats, along: Floats) -> Floats:
    """Return a place (3,) and a unit tangent (3,) as the target (15,) of the end of the first so many segments."""
    row = np.zeros(TARGET_WIDTH)
    row[TARGET_SEGMENT], row[HAS_POSITION], row[ORIENTATION] = count - 1.0, 1.0, DIRECTION
    row[TARGET_POSITION : TARGET_POSITION + 3], row[GOAL : GOAL + 3] = place, along
    return row


def run_about(which: NDArray[np.bool_], at: int) -> tuple[int, int]:
    """Return the first and the last of the neighbours of a point that are all so."""
    others = np.flatnonzero(~which)
    before, after = others[others < at], others[others > at]
    return int(before[-1]) + 1 if len(before) else 0, int(after[0]) - 1 if len(after) else len(which) - 1
