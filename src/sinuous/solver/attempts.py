"""Attempts: the query and its starts, the names of attempts, their queue, and the effort that each has taken."""

import heapq
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from itertools import count
from typing import NamedTuple

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.tables import RANDOM, SOURCES
from sinuous.problem.problem import Problem

Deadline = Callable[[], float]
"""When a solve has to end: says how many seconds are left until then."""


@dataclass(frozen=True)
class StartBatch:
    """Starts to be followed one after the other, until one is solved.

    Attributes
    ----------
    source : str
        Where they come from; starts that the method makes by itself report their own source.
    initial : ndarray (g, n, 3)
        Initial configurations.
    own : (int, int)
        Numbers of starts that the method makes by itself in compiled code, after the initial configurations, from the
        first up to, without it, the last: number 0 is the single arc, all others are scattered.
    effort : float
        What it took to make the batch, beside what its attempt takes anyway, in scattered starts.
    closed : float or None
        Edge of the cells by which it was proved that there is no route; `None` where nothing is proved.
    routes : tuple of ndarray (k, 3)
        Of every initial configuration the route that it was fitted to; empty where they come from elsewhere.
    """

    source: str
    initial: Floats
    own: tuple[int, int] = (0, 0)
    effort: float = 0.0
    closed: float | None = None
    routes: tuple[Floats, ...] = ()

    @property
    def size(self) -> int:
        """How many starts there are."""
        return len(self.initial) + self.own[1] - self.own[0]

    def parts(self, most: Callable[[], int]) -> Iterator["StartBatch"]:
        """Cut it into batches of at most so many starts, asked anew for every part."""
        at = 0
        while at < len(self.initial):
            count = most()
            some = slice(at, at + count)
            yield replace(self, initial=self.initial[some], routes=self.routes[some], own=(0, 0))
            at += count
        first, last = self.own
        nothing = self.initial[:0]
        while first < last:
            end = min(last, first + most())
            yield replace(self, initial=nothing, routes=(), own=(first, end))
            first = end


class IKQuery(NamedTuple):
    """What starts are asked for.

    Attributes
    ----------
    problem : Problem
    initial : ndarray (g, n, 3)
        The initial configuration of the user: g is 0 or 1.
    deadline : callable
        See `Deadline`.
    several : bool
        Whether several distinct solutions are wanted, and not just the first.
    """

    problem: Problem
    initial: Floats
    deadline: Deadline
    several: bool = False


class RandomRestarts:
    """Shapes scattered over all possible ones; the method makes them by itself, from their numbers.

    Parameters
    ----------
    first, last : int
        Numbers of the first one, and of the one after the last.
    """

    name = SOURCES[RANDOM]

    def __init__(self, first: int, last: int) -> None:
        self._next, self._last = first, last

    def take(self, question: IKQuery, count: int) -> StartBatch:
        """Return the next `count` of them, or as many as are left."""
        first = self._next
        self._next = min(self._last, first + count)
        return StartBatch(self.name, question.initial[:0], (first, self._next))

    def continue_from(self, number: int) -> None:
        """Let this number be the next one: those after it were taken, and not followed."""
        self._next = number


REMEMBERED, SCATTERED, EDGES, SIDE_TUBES = "remembered", "scattered", "edges", "side_tubes"
"""Names of attempts that others have to know."""

ATTEMPTS = {
    REMEMBERED: "shapes of a memory whose poses are nearest to the targets",
    SCATTERED: "starts scattered over all shapes, beyond those of the first call",
    "base_tube": "chains fitted to the tube that the base lies in",
    EDGES: "a route around edges",
    SIDE_TUBES: "a route through tubes that open beside edges",
    "cells": "routes over the cells of a grid, coarse and then fine ones",
    "laid": "chains fitted to routes",
    "grown": "chains grown along routes from both ends, and joined, by wider and wider beams",
    "detours": "chains grown along routes that are led aside until they are as long as the robot",
    "gates": "chains through the narrowest place of a route, of which each half is solved by itself",
    "passages": "routes through other passages; for `solve_all` those that no solution leads through yet",
}
"""All attempts, by the names with which they are switched off, and what each makes."""

ROUND = 64
"""Scattered starts of the first batch when nothing else is left to be tried; each following batch has twice as many."""

EFFORT_OF_A_CHAIN = 1
"""Effort of a start that is given, in scattered starts, beside that of its attempt."""


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
    priority : float
        Of all attempts the one with the least priority comes next.
    number : int
        Of those with the same priority, the one that was added first.
    name : str
        One of `ATTEMPTS`.
    effort : float
        What is added to the effort spent when it yields its first batch: without any there was nothing to do.
    make : callable
        Makes the starts.
    """

    priority: float
    number: int
    name: str
    effort: float
    make: Callable[[], Iterator[StartBatch]]


class AttemptQueue:
    """All that is tried for one question after the first call: the one with the lowest priority first.

    Parameters
    ----------
    question : IKQuery
    scattered : RandomRestarts
        The scattered starts that the first call has left.
    share : float
        Scattered starts for each unit of effort of other attempts.
    without : collection of str
        Attempts that are switched off.

    Attributes
    ----------
    effort_spent : dict of str to float
        What each attempt has taken so far, by its name, in scattered starts.
    """

    def __init__(
        self, question: IKQuery, scattered: RandomRestarts, share: float = 1.0, without: Collection[str] = ()
    ) -> None:
        self._question, self._scattered, self._share = question, scattered, share
        self.without = frozenset(without)
        self._queue: list[Attempt] = []
        self._numbers = count()
        self.effort_spent: defaultdict[str, float] = defaultdict(float)

    def add(
        self, name: str, priority: float, make: Callable[[], Iterator[StartBatch]], effort: float | None = None
    ) -> None:
        """Add an attempt, unless it is switched off; its effort is its priority where nothing else is said."""
        if name not in self.without:
            effort = priority if effort is None else effort
            heapq.heappush(self._queue, Attempt(priority, next(self._numbers), name, effort, make))

    def batches(self) -> Iterator[StartBatch]:
        """Yield starts; an attempt works only when its next batch is asked for."""
        while self._queue and self._question.deadline() > 0.0:
            attempt = self._next()
            for number, batch in enumerate(attempt.make()):
                yield batch
                own = attempt.effort if number == 0 else 0.0
                effort = batch.effort + EFFORT_OF_A_CHAIN * len(batch.initial) + own
                self.effort_spent[attempt.name] += effort + batch.own[1] - batch.own[0]
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
        """Yield as many scattered starts as are due for the effort of other attempts."""
        others = sum(effort for name, effort in self.effort_spent.items() if name != SCATTERED)
        due = int(self._share * others - self.effort_spent[SCATTERED])
        if due > 0 and SCATTERED not in self.without:
            self.effort_spent[SCATTERED] += due
            yield self.restart_batch(due)
