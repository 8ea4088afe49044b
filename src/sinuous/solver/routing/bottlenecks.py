"""Robots cut in two at the narrowest place of a route: one part that ends there, along the route, and one from there.

Two problems of half the segments are far easier than one of all: where one start of a hundred leads through a door, and
one of a hundred from there to the target, it is one of ten thousand that does both.
"""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t
from sinuous.kernels.fitting.query import ball_radius
from sinuous.solver.attempts import Deadline
from sinuous.solver.polylines import lengths_along
from sinuous.solver.routing.growth import segments_of
from sinuous.solver.routing.partial_problems import (
    Groups,
    fit_first_segments,
    problem_before,
    problem_beyond,
    search_part,
    segments_in,
)

WIDE = 3.0
"""Distance from the obstacles across a route, in radii of the body, from which on no place of it is narrow."""

NARROW = 1.35
"""Distance up to which a place is as narrow as the narrowest one, in units of that one's."""

ENDS = 0.04
"""Share of a leg at either end that is not looked at: an end may lie in a narrow place."""

TANGENT = 3
"""Points on either side over which the tangent of a route is taken."""

STRETCHED = 0.95
"""Least length of a part, in lengths of its part of the route: the route does not cut corners."""

BARELY = 0.15
"""Share of a segment that may stick out of a long narrow place and still counts as in it."""


class PartSearch:
    """One part of a robot, solved with more and more scattered starts.

    Parameters
    ----------
    groups : tuple of ndarray
        Its problem, see `Groups`.

    Attributes
    ----------
    nearest : ndarray (m, 3) or None
        What came nearest to a solution.
    possible : bool
        Whether it is not proved that there is none.
    """

    def __init__(self, groups: Groups) -> None:
        self._groups, self._n = groups, int(groups[0][0])
        self._starts = 0
        self._least = math.inf
        self._q: Floats | None = None
        self.nearest: Floats | None = None
        self.possible = True

    def solve(self, starts: int, deadline: Deadline) -> Floats | None:
        """Return a configuration (m, 3) that is proved, from at most so many starts in all."""
        own, self._starts = (self._starts, starts), max(starts, self._starts)
        if self._q is None and self.possible and own[0] < starts:
            found = search_part(self._groups, np.empty((0, self._n, 3)), own, deadline)
            self.possible = found.code < t.OUT_OF_REACH
            if found.merit < self._least:
                self._least, self.nearest = found.merit, found.q
            if found.code == t.SOLVED:
                self._q = found.q
        return self._q


class BottleneckDecomposition:
    """A robot cut in two at the narrowest place of a route.

    The more segments are before the place, the harder the part before it is, and the easier that beyond, unless there
    are too few to get there: their number is found by halving.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    legs : ndarray (l, K, 3)
        The legs of a route, evenly spaced, in the length unit.
    widths : ndarray (l, K)
        Greatest distance from the obstacles in the plane across the route at these points, in the length unit.
    """

    def __init__(self, groups: Groups, legs: Floats, widths: Floats) -> None:
        self._groups, self._legs = groups, legs
        self._heads: dict[int, PartSearch] = {}
        self._tails: dict[int, tuple[Floats, PartSearch]] = {}
        skipped = max(1 + TANGENT, round(ENDS * legs.shape[1]))
        looked = widths[:, skipped:-skipped]
        self._which = which = int(looked.min(axis=1).argmin())
        own = looked[which]
        first, last = _run_about(own <= NARROW * max(0.0, own.min()), int(own.argmin()))
        spacing = lengths_along(legs[which])[-1] / (legs.shape[1] - 1)
        deep = round(min(max(0.0, own.min() / spacing), last - first)) if spacing > 0.0 else 0
        self._long = (last - first - deep) * spacing > segments_in(groups[0])[:, t.MAX_LENGTH].mean()
        self._at = skipped + (min(first + deep, last) if self._long else (first + last) // 2)
        self._end = skipped + last if self._long else self._at
        narrow = own.min() < WIDE * ball_radius(segments_in(groups[0])) and first > 0 and last < len(own) - 1
        self._counts = self._possible() if narrow else []

    @property
    def any(self) -> bool:
        """Whether there is a narrow place, and segments for both parts."""
        return len(self._counts) > 0

    def chains(self, starts: int, deadline: Deadline) -> Iterator[Floats]:
        """Yield chains (n, 3) through the narrow place, each part of at most so many scattered starts."""
        low, high, i = 0, len(self._counts) - 1, self._even
        while low <= high and deadline() > 0.0:
            chain, through = self._solved(self._counts[i], starts, deadline)
            if chain is not None:
                yield chain
            low, high = (i + 1, high) if through else (low, i - 1)
            i = (low + high) // 2

    def _possible(self) -> list[int]:
        """Numbers of segments that may be before the place; sets the one that stows as much in both parts."""
        legs, at = self._legs, self._at
        ends = [-1, *segments_of(self._groups)[-len(legs) :]]
        first = ends[self._which] + 1
        own = segments_in(self._groups[0])[first : ends[self._which + 1] + 1]
        low, high = (np.append(0.0, np.cumsum(own[:, which])) for which in (t.MIN_LENGTH, t.MAX_LENGTH))
        along = STRETCHED * lengths_along(legs[self._which])
        gone, rest = along[at], along[-1] - along[at]
        counts = [m for m in range(1, len(own)) if high[m] >= gone and high[-1] - high[m] >= rest]
        mean = 0.5 * (low + high)
        stowed = [(mean[m] - gone) / m - (mean[-1] - mean[m] - rest) / (len(own) - m) for m in counts]
        self._even = int(np.abs(stowed).argmin()) if counts else 0
        return [first + m for m in counts]

    def _solved(self, count: int, starts: int, deadline: Deadline) -> tuple[Floats | None, bool]:
        """Return a chain with so many segments before the place, and whether more may be there.

        Where the second part is not solved, what came nearest is taken: the whole chain has more freedom.
        """
        if count not in self._heads:
            self._heads[count] = PartSearch(problem_before(self._groups, self._row(count)))
        head = self._heads[count].solve(starts, deadline)
        if head is None:
            return None, not self._heads[count].possible
        if count not in self._tails:
            within = self._within(problem_beyond(self._groups, head), deadline)
            self._tails[count] = within, PartSearch(problem_beyond(self._groups, np.concatenate([head, within])))
        within, part = self._tails[count]
        tail = part.solve(starts, deadline)
        tail = part.nearest if tail is None else tail
        return (None if tail is None else np.concatenate([head, within, tail])), True

    def _within(self, rest: Groups, deadline: Deadline) -> Floats:
        """The segments (m, 3) that lie in a long narrow place beyond the first part, fitted to the route."""
        line = self._legs[self._which][self._at : self._end + 1]
        if not self._long:
            return np.empty((0, 3))
        low, high = (segments_in(rest[0])[:-1, which] for which in (t.MIN_LENGTH, t.MAX_LENGTH))
        ends = np.cumsum(0.5 * (low + high))
        count = int(np.searchsorted(ends, lengths_along(line)[-1] + BARELY * high.mean()))
        return fit_first_segments(rest, count, line, max(0.0, deadline()))

    def _row(self, count: int) -> Floats:
        """The place and the tangent of the route there, as a target (15,) of the end of the first segments."""
        leg, at = self._legs[self._which], self._at
        ahead = leg[at + TANGENT] - leg[at - TANGENT]
        row = np.zeros(t.TARGET_WIDTH)
        row[t.TARGET_SEGMENT], row[t.HAS_POSITION], row[t.ORIENTATION] = count - 1.0, 1.0, t.DIRECTION
        row[t.TARGET_POSITION : t.TARGET_POSITION + 3] = leg[at]
        row[t.GOAL : t.GOAL + 3] = ahead / np.linalg.norm(ahead)
        return row


def _run_about(which: NDArray[np.bool_], at: int) -> tuple[int, int]:
    """First and last of the neighbours of a point (K,) that are all so."""
    others = np.flatnonzero(~which)
    behind, ahead = others[others < at], others[others > at]
    return int(behind[-1]) + 1 if len(behind) else 0, int(ahead[0]) - 1 if len(ahead) else len(which) - 1
