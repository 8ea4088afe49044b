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

from sinuous.checks import Floats

GENERATION = 16
"""Candidates of a generation."""

SCATTERED = 4
"""First generations, whose candidates are anywhere."""

ANYWHERE, ELSEWHERE = 0.06, 0.15
"""Share of the later candidates that are anywhere, and of those with another combination."""

NEAREST, FARTHEST = 1e-3, 0.5
"""Sizes of steps, as shares of the ranges: any order of magnitude between the two is as likely."""

PARENTS = 6
"""Most candidates that others are drawn near, beside those that nothing is better than."""

Whole = NDArray[np.int64]


class Candidates(NamedTuple):
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
    """

    combination: Whole
    shares: Floats
    done: Whole
    share: Floats
    objectives: Floats
    failed: Whole

    @classmethod
    def joined(cls, parts: Sequence["Candidates"]) -> "Candidates":
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


class Search:
    """Draws generations.

    Parameters
    ----------
    open_combinations : sequence of int
        Those that no proof has cut.
    ranges : int
        How many.
    seed : int
    known : (int, ndarray (d,)), optional
        The template, where it is one of these robots.
    """

    def __init__(
        self, open_combinations: Sequence[int], ranges: int, seed: int, known: tuple[int, Floats] | None
    ) -> None:
        self._open, self._ranges, self._seed, self._known = np.array(open_combinations), ranges, seed, known

    def generation(self, number: int, found: Sequence[Candidates]) -> tuple[Whole, Floats]:
        """Combinations (k,) and shares (k, d) of a generation, after those that were `found` before it."""
        rng = np.random.default_rng([self._seed, number])
        if number < SCATTERED or not found:
            combination, shares = self._scattered(rng, GENERATION)
        else:
            combination, shares = self._near(rng, Candidates.joined(found))
        if number == 0 and self._known is not None:
            combination[0], shares[0] = self._known
        return combination, shares

    def _scattered(self, rng: Generator, count: int) -> tuple[Whole, Floats]:
        """Candidates anywhere: in each range one in each of as many equal parts (Latin hypercube)."""
        parts = np.array([rng.permutation(count) for _ in range(self._ranges)]).reshape(self._ranges, count).T
        shares = (parts + rng.random((count, self._ranges))) / count
        turns = np.resize(rng.permutation(self._open), count)
        return turns, shares

    def _near(self, rng: Generator, found: Candidates) -> tuple[Whole, Floats]:
        """Candidates near parents: along some of the ranges, by steps of any size, and up to the ends of them."""
        parents = self._parents(found)
        chosen = rng.choice(parents, GENERATION)
        combination, shares = found.combination[chosen].copy(), found.shares[chosen].copy()
        away, other = self._scattered(rng, GENERATION)
        for i in range(GENERATION):
            kind = rng.random()
            if kind < ANYWHERE:
                combination[i], shares[i] = away[i], other[i]
                continue
            if kind < ANYWHERE + ELSEWHERE:
                combination[i] = away[i]
            size = np.exp(rng.uniform(np.log(NEAREST), np.log(FARTHEST)))
            moves = rng.random(self._ranges) < 0.5
            if self._ranges and not moves.any():
                moves[rng.integers(self._ranges)] = True
            shares[i] = np.clip(shares[i] + size * moves * rng.normal(size=self._ranges), 0.0, 1.0)
        return combination, shares

    @staticmethod
    def _parents(found: Candidates) -> Whole:
        """The front of those that count; without any, those that do most."""
        best = front(found.objectives)
        tried = np.flatnonzero(found.failed != -2)
        order = tried[np.lexsort((-found.share[tried], -found.done[tried]))][:PARENTS]
        if not len(best):
            return order
        own = found.objectives[:, 0]
        near = np.flatnonzero(np.isfinite(own))
        return np.union1d(best, near[np.argsort(own[near], kind="stable")][:PARENTS])
