"""The search for robots: generations of candidates, each near the best that are known, or anywhere.

A candidate is a combination of listed values and a point of the ranges. It is drawn from the seed and from what the
generations before it found, and from nothing else; so a search that was interrupted goes on as if it had not been,
and any number of workers finds the same.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from sinuous.base.checks import Floats

GENERATION_SIZE = 16
"""Candidates of a generation."""

SCATTERED_GENERATIONS = 4
"""First generations, whose candidates are anywhere."""

ANYWHERE_FRACTION, OTHER_VALUES_FRACTION = 0.06, 0.15
"""Share of the later candidates that are anywhere, and of those with another combination."""

LEAST_STEP, LARGEST_STEP = 1e-3, 0.5
"""Sizes of steps, as shares of the ranges: any order of magnitude between the two is as likely."""

DESCENT_COUNT, DESCENT_PERIOD = 4, 6
"""Candidates that are led down by derivatives, and how many generations there are from one time to the next."""

MOST_PARENTS = 6
"""Most candidates that others are drawn near, beside those that nothing is better than."""

Whole = NDArray[np.int64]


class Drawn(NamedTuple):
    """Robots that are to be judged.

    Attributes
    ----------
    combination : ndarray of int (k,)
    shares : ndarray (k, d)
    begin : ndarray (k, t, N, 3)
        Where answers to the tasks are looked for; NaN: anywhere.
    source : ndarray of int (k,)
        The candidate that a descent goes on from; -1: none does.
    which : ndarray of int (k,)
        The objective that it lowers.
    """

    combination: Whole
    shares: Floats
    begin: Floats
    source: Whole
    which: Whole


class RobotCandidates(NamedTuple):
    """Robots, and what they reached.

    Attributes
    ----------
    combination : ndarray of int (k,)
    shares : ndarray (k, d)
    done : ndarray of int (k,)
    share : ndarray (k,)
    objectives : ndarray (k, o)
        Infinite where they do not count.
    failed : ndarray of int (k,)
        The first task that is not done; -1: none; -2: it was not tried.
    answers : ndarray (k, t, N, 3)
    source : ndarray of int (k,)
        As it was drawn.
    tried : ndarray of int (k,)
        How many were judged for it.
    """

    combination: Whole
    shares: Floats
    done: Whole
    share: Floats
    objectives: Floats
    failed: Whole
    answers: Floats
    source: Whole
    tried: Whole

    @classmethod
    def joined(cls, parts: Sequence["RobotCandidates"]) -> "RobotCandidates":
        """One after the other."""
        return cls(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def front(objectives: Floats) -> Whole:
    """Numbers of those (k, o) that no other is better than, by the first objective; of equal ones the first."""
    order = np.lexsort(objectives.T[::-1])
    kept: list[int] = []
    for i in order:
        own = objectives[i]
        if np.isfinite(own).all() and not any((objectives[j] <= own).all() for j in kept):
            kept.append(int(i))
    return np.array(kept, np.int64)


class RobotSearch:
    """Draws generations.

    Parameters
    ----------
    open_combinations : sequence of int
        Those that no proof has cut.
    ranges : int
        How many.
    seed : int
    answers : (int, int)
        How many tasks there are, and most segments.
    known : (int, ndarray (d,)), optional
        The template, where it is one of these robots.
    descends : bool
        Whether candidates can be led down by derivatives.
    """

    def __init__(
        self,
        open_combinations: Sequence[int],
        ranges: int,
        seed: int,
        answers: tuple[int, int] = (0, 1),
        known: tuple[int, Floats] | None = None,
        descends: bool = False,
    ) -> None:
        self._open, self._ranges, self._seed, self._known = np.array(open_combinations), ranges, seed, known
        self._nothing, self._descends = np.full((GENERATION_SIZE, *answers, 3), np.nan), descends

    def generation(self, number: int, found: Sequence[RobotCandidates]) -> Drawn:
        """Draw a generation, after those that were `found` before it."""
        rng = np.random.default_rng([self._seed, number])
        if number < SCATTERED_GENERATIONS or not found:
            combination, shares = self._scattered(rng, GENERATION_SIZE)
            if number == 0 and self._known is not None:
                combination[0], shares[0] = self._known
            nowhere = np.full(GENERATION_SIZE, -1)
            return Drawn(combination, shares, self._nothing, nowhere, nowhere)
        joined = RobotCandidates.joined(found)
        if self._descends and (number - SCATTERED_GENERATIONS) % DESCENT_PERIOD == 0:
            source, which = self._sources(joined)
            if len(source):
                return Drawn(joined.combination[source], joined.shares[source], joined.answers[source], source, which)
        return self._near(rng, joined)

    @staticmethod
    def _sources(found: RobotCandidates) -> tuple[Whole, Whole]:
        """Candidates to go down from, and by which objective: the best, and the best of those that were anywhere."""
        source: list[int] = []
        which: list[int] = []
        counts = np.isfinite(found.objectives).all(axis=1) & (found.source < 0)
        counts[found.source[found.source >= 0]] = False
        for i in range(DESCENT_COUNT):
            objective = i % found.objectives.shape[1]
            left = np.flatnonzero(counts)
            early = left[left < SCATTERED_GENERATIONS * GENERATION_SIZE]
            left = early if i and len(early) else left
            if len(left):
                fresh = left[~np.isin(found.combination[left], found.combination[source])]
                own = fresh if len(fresh) else left
                best = int(own[np.argmin(found.objectives[own, objective])])
                source.append(best)
                which.append(objective)
                counts[best] = False
        return np.array(source, np.int64), np.array(which, np.int64)

    def _scattered(self, rng: Generator, count: int) -> tuple[Whole, Floats]:
        """Candidates anywhere: in each range one in each of as many equal parts (Latin hypercube)."""
        parts = np.array([rng.permutation(count) for _ in range(self._ranges)]).reshape(self._ranges, count).T
        shares = (parts + rng.random((count, self._ranges))) / count
        turns = np.resize(rng.permutation(self._open), count)
        return turns, shares

    def _near(self, rng: Generator, found: RobotCandidates) -> Drawn:
        """Candidates near parents: along some of the ranges, by steps of any size, and up to the ends of them."""
        parents = self._parents(found)
        chosen = rng.choice(parents, GENERATION_SIZE)
        combination, shares = found.combination[chosen].copy(), found.shares[chosen].copy()
        begin = found.answers[chosen].copy()
        away, other = self._scattered(rng, GENERATION_SIZE)
        for i in range(GENERATION_SIZE):
            kind = rng.random()
            if kind < ANYWHERE_FRACTION:
                combination[i], shares[i], begin[i] = away[i], other[i], np.nan
                continue
            if kind < ANYWHERE_FRACTION + OTHER_VALUES_FRACTION:
                combination[i] = away[i]
            size = np.exp(rng.uniform(np.log(LEAST_STEP), np.log(LARGEST_STEP)))
            moves = rng.random(self._ranges) < 0.5
            if self._ranges and not moves.any():
                moves[rng.integers(self._ranges)] = True
            shares[i] = np.clip(shares[i] + size * moves * rng.normal(size=self._ranges), 0.0, 1.0)
        begin[combination != found.combination[chosen]] = np.nan
        nowhere = np.full(GENERATION_SIZE, -1)
        return Drawn(combination, shares, begin, nowhere, nowhere)

    @staticmethod
    def _parents(found: RobotCandidates) -> Whole:
        """The front of those that count; without any, those that do most."""
        best = front(found.objectives)
        tried = np.flatnonzero(found.failed != -2)
        order = tried[np.lexsort((-found.share[tried], -found.done[tried]))][:MOST_PARENTS]
        if not len(best):
            return order
        own = found.objectives[:, 0]
        near = np.flatnonzero(np.isfinite(own))
        return np.union1d(best, near[np.argsort(own[near], kind="stable")][:MOST_PARENTS])
