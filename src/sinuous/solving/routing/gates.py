"""Gates: poses in the narrowest places of a route, through which chains are grown.

A chain that comes to a narrow place at a slant is lost there, and what leads into it straight is one chain among many.
So the end of one of its segments is asked to lie in that place, along the route, as if it were an elbow.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import (
    DIRECTION,
    GOAL,
    HAS_POSITION,
    MAX_LENGTH,
    ORIENTATION,
    RADIUS,
    ROBOT_HEADER,
    SEGMENT_WIDTH,
    TARGET_POSITION,
    TARGET_SEGMENT,
    TARGET_WIDTH,
)
from sinuous.solving.routing.growth import LEG_POINTS, respaced, segments_of
from sinuous.solving.routing.turned import Groups

NARROW, WIDE = 1.1, 2.5
"""Up to so many times the least distance a place is as narrow as the narrowest one; and distance, in radii of the body,
from which on no place is narrow."""

SHIFTS, INWARDS = (0.0, -0.5, 0.5), (0.25, 0.75, 0.0)
"""How far beyond a narrow place the gate lies, in lengths of a segment; and how far beyond where one begins that is
longer than a segment."""

SHARES = (0.5, 0.75, 0.25, 1.0, 0.0)
"""Of the numbers of segments that may lie before a gate: which are tried, from the fewest to the most."""

STRETCHED = 0.95
"""Of the length of a route, the least that a chain along it can have."""

TANGENT = 3
"""Points on either side that the tangent of a route is taken over."""

ENDS = 0.04
"""Of a leg, what is not looked at, at its ends."""


class Gate(NamedTuple):
    """A pose that the end of a segment is to have.

    Attributes
    ----------
    row : ndarray (15,)
        That as a target.
    legs : ndarray (l, K, 3)
        The legs of the route, one of which is divided at the gate.
    """

    row: Floats
    legs: Floats

    def asked(self, groups: Groups) -> Groups:
        """Return a problem with the gate among its targets."""
        robot, scene, settings, targets = groups
        return robot, scene, settings, np.vstack([targets, self.row])


class Passage:
    """The narrowest place of the legs of a route, and the gates there.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    legs : ndarray (l, K, 3)
        The legs of a route, evenly spaced, in the length unit.
    distances : ndarray (l, K)
        Of these points from the obstacles, in the length unit.
    """

    def __init__(self, groups: Groups, legs: Floats, distances: Floats) -> None:
        robot, n = groups[0], int(groups[0][0])
        segments = robot[ROBOT_HEADER : ROBOT_HEADER + SEGMENT_WIDTH * n].reshape(n, SEGMENT_WIDTH)
        skipped = max(1 + TANGENT, round(ENDS * legs.shape[1]))
        looked = distances[:, skipped:-skipped]
        self._legs, self._skipped = legs, skipped
        self._which = int(looked.min(axis=1).argmin())
        ends = [-1, *segments_of(groups)[-len(legs) :]]
        self._first = ends[self._which] + 1
        self._own = segments[self._first : ends[self._which + 1] + 1]
        self._length = float(np.linalg.norm(legs[self._which, 1] - legs[self._which, 0]))
        self.room = float(looked[self._which].min() / segments[:, RADIUS].min())
        self._stretch = _stretch(looked[self._which], skipped)
        self._order = sorted(self._all()) if self.room < WIDE else []

    def __len__(self) -> int:
        """How many gates there are."""
        return len(self._order)

    def gate(self, number: int) -> Gate:
        """Return gate `number`, the most promising first."""
        _, at, count = self._order[number]
        leg, segment = self._legs[self._which], self._first + count - 1
        tangent = leg[at + TANGENT] - leg[at - TANGENT]
        row = np.zeros(TARGET_WIDTH)
        row[TARGET_SEGMENT], row[HAS_POSITION], row[ORIENTATION] = segment, 1.0, DIRECTION
        row[TARGET_POSITION : TARGET_POSITION + 3] = leg[at]
        row[GOAL : GOAL + 3] = tangent / np.linalg.norm(tangent)
        parts = [respaced(part, LEG_POINTS) for part in (leg[: at + 1], leg[at:])]
        return Gate(row, np.stack([*self._legs[: self._which], *parts, *self._legs[self._which + 1 :]]))

    def _all(self) -> Iterator[tuple[float, int, int]]:
        """Yield of each gate its rank, at which point of the leg it is, and how many segments are before it."""
        high = np.concatenate([[0.0], np.cumsum(self._own[:, MAX_LENGTH])])
        mean, last = high[-1] / len(self._own), self._legs.shape[1] - 1
        begin, end = self._stretch
        if begin <= self._skipped or end >= last - self._skipped:
            return  # an end lies in it: chains are in there, or get there, without a gate
        inwards = (end - begin) * self._length > mean
        for i, shift in enumerate(INWARDS if inwards else SHIFTS):
            at = (begin if inwards else (begin + end) // 2) + round(shift * mean / self._length)
            if not TANGENT < at < last - TANGENT:
                continue
            before, after = STRETCHED * self._length * at, STRETCHED * self._length * (last - at)
            counts = [m for m in range(1, len(self._own)) if high[m] >= before and high[-1] - high[m] >= after]
            shares = (round(share * (len(counts) - 1)) for share in SHARES)
            for j, which in enumerate(dict.fromkeys(shares) if counts else ()):
                yield 1.1 * i + j, at, counts[which]


def _stretch(distances: Floats, skipped: int) -> tuple[int, int]:
    """First and last point of what is about as narrow as the narrowest place, around it."""
    at, wide = int(distances.argmin()), np.flatnonzero(distances > NARROW * distances.min())
    before, after = wide[wide < at], wide[wide > at]
    first = int(before[-1]) + 1 if len(before) else 0
    last = int(after[0]) - 1 if len(after) else len(distances) - 1
    return first + skipped, last + skipped
