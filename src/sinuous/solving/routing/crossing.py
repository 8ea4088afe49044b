"""Chains through the gates of a passage: part after part, each solved by itself and proved clear."""

import math
from collections.abc import Callable, Iterator

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.solve.search import search
from sinuous.kernels.step.states import workspace_size
from sinuous.kernels.tables import (
    GOAL,
    MERIT,
    MIN_LENGTH,
    OUT_OF_REACH,
    SOLVED,
    TARGET_POSITION,
    TARGET_SEGMENT,
)
from sinuous.solving.polylines import lengths_along
from sinuous.solving.routing.gates import Laid, Passage, Way
from sinuous.solving.routing.growth import FEW, GLANCE, MANY, ONE, SOME, Beam, grown, settled
from sinuous.solving.routing.narrow.tunnels import Tunnel
from sinuous.solving.routing.parts import before, begin, beyond, fitted, laid, segments_in
from sinuous.solving.routing.turned import Groups

STARTS = {GLANCE: 3, ONE: 6, SOME: 20, FEW: 50, MANY: 150}
"""Beams with which parts are grown, from the least effort on, and scattered starts of a part with each."""

AGAIN = 1
"""Numbers of segments before a gate that are tried again with more effort, though those beyond did not get there."""

TAUT = 1.2
"""Least length of a chain, of the leg of a route, up to which it is laid along that."""

STIFF = 3
"""Segments up to which what came nearest to the mouth of a tube is taken: they have too little freedom for a pose."""

SEED = 0
"""Of the scattered starts of parts."""

PLACE, ALONG = slice(TARGET_POSITION, TARGET_POSITION + 3), slice(GOAL, GOAL + 3)
"""Position and direction of a gate, in its row."""

Left = Callable[[], float]
"""Seconds left."""


class Part:
    """One part of a robot, solved with more and more effort.

    Parameters
    ----------
    groups : tuple of ndarray
        Its problem, see `Groups`.
    legs : ndarray (l, K, 3)
        The part of the route that belongs to it, from target to target.

    Attributes
    ----------
    segments : int
    nearest : ndarray (m, 3) or None
        What came nearest to a solution.
    possible : bool
        Whether it is not proved that there is none.
    """

    def __init__(self, groups: Groups, legs: Floats) -> None:
        self._groups, self._legs, self.segments = groups, legs, int(groups[0][0])
        robot, scene, _, targets = groups
        self._workspace = np.empty(workspace_size(int(robot[0]), int(robot[1]), int(scene[0]), len(targets)))
        self._first = self._effort = 0
        self.possible, self._least = True, math.inf
        self._q: Floats | None = None
        self.nearest: Floats | None = None

    def solved(self, most: Beam, left: Left) -> Floats | None:
        """Return a configuration (m, 3) that is proved, with no more effort than this; `None` where none is found."""
        efforts = list(STARTS)
        while self._q is None and self.possible and self._effort <= efforts.index(most) and left() > 0.0:
            beam = efforts[self._effort]
            self._effort += 1
            found = (self._follow(chains, own, left) for chains, own in self._tries(beam, left))
            self._q = next((q for q in found if q is not None), None)
        return self._q

    def _tries(self, beam: Beam, left: Left) -> Iterator[tuple[Floats, tuple[int, int]]]:
        """Yield chains (c, m, 3) and numbers of scattered starts that are to be followed."""
        first, self._first = self._first, self._first + STARTS[beam]
        nothing = np.empty((0, int(self._groups[0][0]), 3))
        yield nothing, (first, self._first)
        if beam == GLANCE and self.possible and self._fits() and left() > 0.0:
            yield fitted(self._groups, self._legs[0], max(0.0, left()))[None], (0, 0)
        if left() > 0.0 and self.possible:
            chains = grown(self._groups, self._legs, beam, left())
            if len(chains):
                yield chains, (0, 0)
                yield np.concatenate([nothing, *(q[None] for q in settled(self._groups, chains, left))]), (0, 0)

    def _fits(self) -> bool:
        """Whether the chain is about as long as its leg: what is longer, and laid along it, is in a heap."""
        shortest = segments_in(self._groups[0])[:, MIN_LENGTH].sum()
        return bool(len(self._legs) == 1 and shortest <= TAUT * lengths_along(self._legs[0])[-1])

    def _follow(self, chains: Floats, own: tuple[int, int], left: Left) -> Floats | None:
        """Follow starts to the first that is solved and proved."""
        best = np.empty((int(self._groups[0][0]), 3))
        record = search(*self._groups, chains, (*own, SEED, max(0.0, left())), self._workspace, best)
        code, merit = record[0], record[MERIT]
        self.possible = self.possible and code < OUT_OF_REACH
        if merit < self._least:
            self._least, self.nearest = merit, best
        return best if code == SOLVED else None


class Parts:
    """The parts of a robot between the gates of one way, each solved from where the one before it ends.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem of the whole, see `Groups`.
    way : Way
    """

    def __init__(self, groups: Groups, way: Way) -> None:
        self._groups, self._rest, self._way = groups, groups, way
        self._parts: list[Part] = []
        self._begun: tuple[Floats, Floats] | None = None

    def solved(self, most: Beam, left: Left) -> tuple[Floats | None, bool]:
        """Return a configuration (n, 3) whose parts are solved, each with no more effort than this; and how far it got.

        That is whether the first part is solved. Where only the last part is not, what came nearest is taken: the whole
        chain has more freedom than its last part. So it is of few segments before a tube: they cannot have any pose.
        """
        chains: list[Floats] = []
        for i in range(len(self._way.legs)):
            if i == len(self._parts):
                self._parts.append(self._next(chains))
            part = self._parts[i]
            chain = part.solved(most, left)
            if chain is None and (i == len(self._way.rows) or (self._way.laid and part.segments <= STIFF)):
                chain = part.nearest
            if chain is None:
                return None, i > 0
            chains.append(self._with_inside(chain, self._way.laid, left) if i == 0 and self._way.laid else chain)
        return np.concatenate(chains), True

    @property
    def too_short(self) -> bool:
        """Whether it is proved that the first part cannot get to its gate: it takes more segments."""
        return bool(self._parts) and not self._parts[0].possible

    def _with_inside(self, chain: Floats, inside: Laid, left: Left) -> Floats:
        """The chain of the first part, and what lies in the tube beyond it. What follows another one is forgotten."""
        if self._begun is None or self._begun[0] is not chain:
            self._parts, self._rest = self._parts[:1], self._groups
            held = laid(beyond(self._groups, chain), inside.segments, inside.line, max(0.0, left()))
            self._begun = chain, np.concatenate([chain, held])
        return self._begun[1]

    def _next(self, chains: list[Floats]) -> Part:
        """The part that follows those of these configurations."""
        rows, done = self._way.rows, len(chains)
        if done > 0:
            self._rest = beyond(self._rest, chains[-1])
        if 0 < done < len(rows):
            gate = rows[done - 1]
            farther = (begin(self._rest) - gate[PLACE]) @ gate[ALONG]
            for row in rows[done:]:
                row[TARGET_SEGMENT] -= len(chains[-1])
                row[PLACE] += farther * row[ALONG]  # what lies between two gates is as long as it is
        own = before(self._rest, rows[done]) if done < len(rows) else self._rest
        return Part(own, self._way.legs[done])


class Crossing:
    """Chains through the gates of a passage.

    The more segments are before a gate, the harder the part before it is, and the easier that beyond, unless there are
    too few to get to the gate: their number is found by halving, with little effort; with more, it goes on from where
    that has ended.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    passage : Passage or Tunnel
    """

    def __init__(self, groups: Groups, passage: Passage | Tunnel) -> None:
        self._groups, self._passage = groups, passage
        self._parts: dict[tuple[int, int], Parts] = {}
        self._reached: dict[int, int] = {}

    def __len__(self) -> int:
        """At how many places there are gates."""
        return len(self._passage.places)

    def chains(self, place: int, most: Beam, left: Left) -> Iterator[Floats]:
        """Yield configurations (n, 3) through the gates at a place, whose parts took no more effort than this."""
        spot = self._passage.places[place]
        low, high, i = 0, len(spot.counts) - 1, spot.even
        before = self._reached.get(place)
        if before is not None:
            low = i = min(max(0, before - AGAIN), high)
        while low <= high and left() > 0.0:
            parts = self._at(place, spot.counts[i])
            chain, through = parts.solved(most, left)
            if chain is not None:
                yield chain
            if most == GLANCE:
                return
            low, high = (i + 1, high) if through or parts.too_short else (low, i - 1)
            self._reached[place] = low
            i = low if before is not None else (low + high) // 2

    def _at(self, place: int, count: int) -> Parts:
        """The parts with so many segments before the gate at a place."""
        key = place, count
        if key not in self._parts:
            self._parts[key] = Parts(self._groups, self._passage.way(place, count))
        return self._parts[key]
