"""Attempts: what each is called, the queue of all that is tried for one question, and the ledger of what was spent."""

import heapq
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator
from itertools import count
from typing import NamedTuple

from sinuous.base.errors import InputError
from sinuous.solver.starts import IKQuery, RandomRestarts, StartBatch

REMEMBERED, SCATTERED, EDGES, SIDE_TUBES = "remembered", "scattered", "edges", "side_tubes"
"""Names of attempts that others have to know."""

ATTEMPTS = {
    REMEMBERED: "shapes of a memory whose poses are nearest to the targets",
    SCATTERED: "starts scattered over all shapes, beyond those of the first call",
    "base_tube": "chains laid along the tube that the base lies in",
    EDGES: "a route around edges",
    SIDE_TUBES: "a route through tubes that open beside edges",
    "cells": "routes over the cells of a grid, coarse and then fine ones",
    "laid": "chains laid along routes",
    "grown": "chains grown along routes from both ends, and joined, by wider and wider beams",
    "detours": "chains grown along routes that are led aside until they are as long as the robot",
    "gates": "chains through the narrowest place of a route, of which each half is solved by itself",
    "passages": "routes through other passages; for `solve_all` those that no solution leads through yet",
}
"""All attempts, by the names with which they are switched off, and what each makes."""

ROUND = 64
"""Scattered starts of the first batch when nothing else is left to be tried; each following batch has twice as many."""

EFFORT_OF_A_CHAIN = 1
"""Cost of a start that is given, in scattered starts, beside what its attempt costs."""


def read_without(names: object) -> tuple[str, ...]:
    """Check names of attempts that are to be switched off.

    Raises
    ------
    InputError
        Where one is not known.
    """
    listed = (names,) if isinstance(names, str) else names
    expected = "names of attempts: " + ", ".join(ATTEMPTS)
    if not isinstance(listed, list | tuple | set | frozenset):
        raise InputError("without", "", names, expected)
    for name in listed:
        if not isinstance(name, str) or name not in ATTEMPTS:
            raise InputError("without", "is not known", name, expected)
    return tuple(name for name in ATTEMPTS if name in listed)


class Attempt(NamedTuple):
    """Something to be tried: smaller comes first.

    Attributes
    ----------
    price : float
        Of all attempts the one with the least price comes next.
    number : int
        Of those with the same price, the one that was added first.
    name : str
        One of `ATTEMPTS`.
    cost : float
        What is put down in the ledger when it yields its first batch: without any there was nothing to do.
    make : callable
        Makes the starts.
    """

    price: float
    number: int
    name: str
    cost: float
    make: Callable[[], Iterator[StartBatch]]


class AttemptQueue:
    """All that is tried for one question after the first call: the cheapest first.

    Parameters
    ----------
    question : Question
    scattered : Scattered
        The scattered starts that the first call has left.
    share : float
        Scattered starts for each unit of cost of other attempts.
    without : collection of str
        Attempts that are switched off.

    Attributes
    ----------
    ledger : dict of str to float
        What each attempt has cost so far, by its name.
    """

    def __init__(
        self, question: IKQuery, scattered: RandomRestarts, share: float = 1.0, without: Collection[str] = ()
    ) -> None:
        self._question, self._scattered, self._share = question, scattered, share
        self.without = frozenset(without)
        self._queue: list[Attempt] = []
        self._numbers = count()
        self.ledger: defaultdict[str, float] = defaultdict(float)

    def add(self, name: str, price: float, make: Callable[[], Iterator[StartBatch]], cost: float | None = None) -> None:
        """Add an attempt, unless it is switched off; its cost is its price where nothing else is said."""
        if name not in self.without:
            cost = price if cost is None else cost
            heapq.heappush(self._queue, Attempt(price, next(self._numbers), name, cost, make))

    def batches(self) -> Iterator[StartBatch]:
        """Yield starts; an attempt works only when its next batch is asked for."""
        while self._queue and self._question.deadline() > 0.0:
            attempt = self._next()
            for number, batch in enumerate(attempt.make()):
                yield batch
                cost = batch.cost + EFFORT_OF_A_CHAIN * len(batch.initial) + (attempt.cost if number == 0 else 0.0)
                self.ledger[attempt.name] += cost + batch.own[1] - batch.own[0]
            yield from self._due_restarts()
        size = ROUND
        while SCATTERED not in self.without:
            batch = self.restart_batch(size)
            if batch.size == 0:
                return
            yield batch
            size *= 2

    def restart_batch(self, count: int) -> StartBatch:
        """Return the next so many scattered starts, or as many as are left."""
        return self._scattered.take(self._question, count)

    def _next(self) -> Attempt:
        return heapq.heappop(self._queue)

    def _due_restarts(self) -> Iterator[StartBatch]:
        """Yield as many scattered starts as are due for what other attempts have cost."""
        others = sum(cost for name, cost in self.ledger.items() if name != SCATTERED)
        due = int(self._share * others - self.ledger[SCATTERED])
        if due > 0 and SCATTERED not in self.without:
            self.ledger[SCATTERED] += due
            yield self.restart_batch(due)
