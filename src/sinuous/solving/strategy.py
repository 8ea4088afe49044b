"""What a solve tries, in which order, and at which cost: the whole strategy in one file.

A solve begins with a compiled call that follows a few starts (`opening_starts`): most solves end there. What is left
undecided goes through a queue of attempts, the cheapest first. An attempt makes starts, and may add further attempts: a
route that was found adds 'lay a chain along it', 'grow chains along it', each with more and more effort. After each
attempt scattered starts follow, in proportion to what it cost. It ends with the first solution, a proof, the time, or
the most starts that the user allows.

Everything that is counted here is counted in *scattered starts*: what one takes, on average, to be followed. None of it
is measured while it runs, so that the same seed gives the same answer, unless the time runs out.

Two numbers belong to an attempt. Its *price* says when it is made: all that is cheaper comes before it. Its *cost* is
what is put down for it in the ledger, once it is made, and what scattered starts are in proportion to. For most
attempts both are the same; a price is higher where an attempt succeeds seldom, and is multiplied by the weight of its
route, so that the second route is worth half as much as the first one.

The figures were set on the places of `python -m benchmarks clutter`; with each are named the families that it matters
for most.
"""

import heapq
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator
from functools import partial
from itertools import count
from typing import NamedTuple

import numpy as np

from sinuous.errors import InputError
from sinuous.kernels.tables import GIVEN, PROVED_CLOSED, SOURCES
from sinuous.solving.routing.candidates import EDGES, SIDE_TUBES, Candidate, Candidates, along
from sinuous.solving.routing.chains import FIRST_WIDTH, LAST_WIDTH
from sinuous.solving.routing.growth import FEW, GLANCE, MANY, ONE, SOME
from sinuous.solving.routing.plans import CELLS, Plan
from sinuous.solving.routing.searches import Searches
from sinuous.solving.starts import Batch, Question, Scattered

ATTEMPTS = {
    "scattered": "starts scattered over all shapes, beyond those of the first call",
    "base_tube": "chains laid along the tube that the base lies in",
    EDGES: "a route around edges",
    SIDE_TUBES: "a route through tubes that open beside edges",
    "cells": "routes over the cells of a grid, coarse and then fine ones",
    "laid": "chains laid along routes",
    "grown": "chains grown along routes from both ends, and joined, by wider and wider beams",
    "gates": "chains through the narrowest place of a route, part by part",
    "passages": "for `solve_all`: routes through passages that no solution leads through yet",
}
"""All attempts, by the names with which they are switched off, and what each makes."""

OPENING = 3
"""Starts of the first call among obstacles: most that suffice are among the first, and routes are known as soon."""

OPENING_ALONE = 16
"""Starts of the first call where no attempt but scattered starts follows."""

SHARE = 0.6
"""Scattered starts for each unit of cost in the ledger. More helps among balls, less in tubes."""

SHARE_AMONG_BALLS = 2.0
"""The same where all obstacles are balls and capsules: they enclose nothing, so that chains along a route are hardly
better than scattered starts, and dearer than they are said to be (spheres 40, spheres 100)."""

SCATTERED_FIRST = 3
"""Scattered starts before any route is looked for, where that takes longer than they do: beside meshes, unless these
enclose the base, and where nothing has edges (plates, shelf)."""

CELLS_A_START = 250
"""Cells that a search looks at in the time of one scattered start (halls, doors)."""

COST_OF_A_CHAIN = 1
"""Cost of a start that is given, beside what its attempt costs."""

AFTER_EDGES = 14
"""Price of the first search over cells, where a route around edges is known: what is tried along that comes before (two
doors, cells)."""

PRICE_FINE = 8
"""Price of the first search over fine cells, or over cells between."""

PRICE_ALTERNATIVES = 20
"""Price of the search over coarse cells for routes that differ."""

PRICE_MANY = 110
"""Price of the search over many fine cells, after one for alternatives."""

PRICE_EXACT = 220
"""Price of searches with exact distances."""

LAST = 440
"""Price of what comes after all searches."""

ALTERNATIVES = 4
"""Routes that differ, of a search for more than one."""

BETWEEN = 3.0
"""Edge of the coarse cells, in edges of the fine ones, from which on cells of twice the finest come between them."""

GROWN_COST = 1.0
"""Cost of chains along a route, for each that beams keep of every number of segments."""

GROWN_SEVERAL = 16
"""Width of beams where several solutions are wanted: chains along one route are much alike."""

GATES_PRICES = {GLANCE: 3, ONE: 4, SOME: 12, FEW: 40, MANY: 150}
"""By beam, the cost of chains through the gates at the first place of a passage, part after part (doors, cells)."""

GATES_LATER = (1.0, 1.5, 3.0)
"""By place, how many times as dear chains through the gates of a passage are: they succeed less often."""

GATES_BLIND = 3.0
"""How many times as dear chains through gates of routes over coarse cells are: many of these cut through walls."""

GATES_GLANCE_BLIND = 4
"""Price of the first glance at the gates of such a route."""

GROWN_ROUTES = 2
"""Routes of one search along which chains are grown; chains are led through the gates of the first one alone."""

AT_ONCE = 0
"""Price of what comes first."""

PASSAGES = -1
"""Price of routes through other passages, where several solutions are wanted: before everything else."""

Passages = Callable[[Question], Iterator[Batch]]
"""From a question to starts along routes through other passages."""


def opening_starts(most: int, given: int, routes: bool) -> int:
    """How many starts the method makes by itself in the first call, after so many initial configurations."""
    return max(0, min(most, OPENING if routes else OPENING_ALONE) - given)


def opening(question: Question, most: int, routes: bool) -> Batch:
    """Return the starts of the first call."""
    return Batch(SOURCES[GIVEN], question.initial, (0, opening_starts(most, len(question.initial), routes)))


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
    make: Callable[[], Iterator[Batch]]


class Strategy:
    """All that is tried for one question after the first call, in the order of prices.

    Parameters
    ----------
    question : Question
    scattered : Scattered
        The scattered starts that the first call has left.
    searches : Searches or None
        What finds routes, where they are searched for.
    without : collection of str
        Attempts that are switched off.
    passages : callable, optional
        From the question to starts along routes through other passages.

    Attributes
    ----------
    ledger : dict of str to float
        What each attempt has cost so far, by its name.
    """

    def __init__(
        self,
        question: Question,
        scattered: Scattered,
        searches: Searches | None = None,
        without: Collection[str] = (),
        passages: Passages | None = None,
    ) -> None:
        self._question, self._scattered, self._without = question, scattered, frozenset(without)
        self._queue: list[Attempt] = []
        self._numbers = count()
        self.ledger: defaultdict[str, float] = defaultdict(float)
        self._share = SHARE
        query = None if searches is None else searches.query(question.problem)
        if searches is not None and query is not None:
            if searches.only_balls(question.problem):
                self._share = SHARE_AMONG_BALLS
            self._searches = searches
            if passages is not None:
                self._add_next(passages(question))
            between = next((plan for _, plan in plans_of(searches) if plan.between), None)
            self._candidates = Candidates(searches, question, query, between, self._without)
            self._add_first()

    def add(self, name: str, price: float, make: Callable[[], Iterator[Batch]], cost: float | None = None) -> None:
        """Add an attempt, unless it is switched off; its cost is its price where nothing else is said."""
        if name not in self._without:
            cost = price if cost is None else cost
            heapq.heappush(self._queue, Attempt(price, next(self._numbers), name, cost, make))

    def batches(self) -> Iterator[Batch]:
        """Yield starts; an attempt works only when its next batch is asked for."""
        while self._queue and self._question.seconds_left() > 0.0:
            attempt = self._next()
            for number, batch in enumerate(attempt.make()):
                yield batch
                cost = batch.cost + COST_OF_A_CHAIN * len(batch.initial) + (attempt.cost if number == 0 else 0.0)
                self.ledger[attempt.name] += cost + batch.own[1] - batch.own[0]
            yield from self._owed()
        if "scattered" not in self._without:
            yield self._scattered.rest(self._question)

    def _next(self) -> Attempt:
        return heapq.heappop(self._queue)

    def _owed(self) -> Iterator[Batch]:
        """Yield as many scattered starts as are due for what other attempts have cost."""
        others = sum(cost for name, cost in self.ledger.items() if name != "scattered")
        due = int(self._share * others - self.ledger["scattered"])
        if due > 0 and "scattered" not in self._without:
            self.ledger["scattered"] += due
            yield self._scattered.take(self._question, due)

    def _add_first(self) -> None:
        """Add what needs no route, and what finds routes."""
        if not self._question.several:
            self.add("base_tube", AT_ONCE, self._candidates.in_tube)
        self.add("scattered", AT_ONCE, self._scattered_first, cost=0)
        for name, find in (
            (EDGES, self._candidates.around_edges),
            (SIDE_TUBES, self._candidates.through_side_tubes),
        ):
            self.add(name, AT_ONCE, partial(self._find_one, find), cost=0)
        self.add("cells", AT_ONCE, partial(self._search, plans_of(self._searches), True), cost=0)

    def _add_next(self, passages: Iterator[Batch]) -> None:
        """Add the next of the routes through other passages, if there is one."""

        def following() -> Iterator[Batch]:
            batch = next(passages, None)
            if batch is not None:
                self._add_next(passages)
                yield batch

        self.add("passages", PASSAGES, following, cost=0)

    def _scattered_first(self) -> Iterator[Batch]:
        """Scattered starts, where looking for a route takes longer."""
        if not (self._candidates.enclosed or self._searches.edges_first(self._question.problem)):
            yield self._scattered.take(self._question, SCATTERED_FIRST)

    def _find_one(self, find: Callable[[np.ndarray], np.ndarray | None]) -> Iterator[Batch]:
        """Look for a route without cells, unless one is known."""
        route = None if self._candidates.known else find(self._candidates.query)
        if route is not None:
            self._add_routes([route], finest=True)
        return iter(())

    def _search(self, searches: list[tuple[float, Plan]], first: bool) -> Iterator[Batch]:
        """Search for routes over cells; add the next search."""
        candidates = self._candidates
        if first and candidates.known:
            searches = [(max(price, AFTER_EDGES), plan) for price, plan in searches if plan.routes > 1]
            self.add("cells", AFTER_EDGES, partial(self._search, searches, False), cost=0)
            return
        searches = [(price, plan) for price, plan in searches if not candidates.pointless(plan)]
        if not searches:
            return
        (_, plan), *others = searches
        last, found = candidates.over_cells_once(plan)
        closed = last.cell if found.ended == PROVED_CLOSED else None
        nothing = np.empty((0, *self._question.initial.shape[1:]))
        self._add_routes(found.routes, last.cell == self._searches.fine.cell, last.exact)
        if others:
            self.add("cells", others[0][0], partial(self._search, others, False), cost=0)
        yield along(nothing, (), cost=found.cells / CELLS_A_START, closed=closed)

    def _add_routes(self, routes: list[np.ndarray], finest: bool, exact: bool = False) -> None:
        """Add all that is tried along the routes (K, 3) of one search."""
        if not routes:
            return
        stowed = self._candidates.to_be_stowed(routes[0])
        for place, route in enumerate(routes):
            candidate, unlike = self._candidates.note(route, finest, exact)
            if candidate is None:
                continue
            if unlike and place < GROWN_ROUTES:
                self._add_grown(candidate)
                if place == 0 and not self._question.several:
                    self._add_gates(candidate)
        price = GATES_PRICES[GLANCE] if stowed else AT_ONCE
        self.add("laid", price, partial(self._candidates.laid, routes), cost=0)

    def _add_along(
        self, name: str, candidate: Candidate, cost: float, make: Callable[[], Iterator[Batch]], times: float = 1.0
    ) -> None:
        self.add(name, cost * times * candidate.weight, make, cost)

    def _add_grown(self, candidate: Candidate) -> None:
        """Add chains along a route; those for several solutions come last, because they are much alike."""
        if self._question.several:
            make = partial(self._candidates.grown, candidate, GROWN_SEVERAL)
            self.add("grown", LAST, make, GROWN_COST * GROWN_SEVERAL)
            return
        width = FIRST_WIDTH
        while width <= LAST_WIDTH:
            make = partial(self._candidates.grown, candidate, width)
            self._add_along("grown", candidate, GROWN_COST * width, make)
            width *= 2

    def _add_gates(self, candidate: Candidate) -> None:
        """Add chains through the narrowest place of a route."""
        for beam, cost in GATES_PRICES.items():
            for place, later in enumerate(GATES_LATER[: 1 if beam == GLANCE else None]):
                times = later * (1.0 if candidate.finest else GATES_BLIND)
                if beam == GLANCE and not candidate.finest:
                    times = GATES_GLANCE_BLIND / cost
                make = partial(self._candidates.through, candidate, beam, place)
                self._add_along("gates", candidate, cost, make, times)


def plans_of(searches: Searches) -> list[tuple[float, Plan]]:
    """Return the searches over cells, from the quickest to the most thorough, each with its price."""
    coarse, fine = searches.coarse, searches.fine
    _, many, most = CELLS
    first: list[tuple[float, Plan]] = []
    second: list[tuple[float, Plan]] = []
    if coarse.cell > fine.cell:
        first.append((AT_ONCE, coarse))
        second.append((PRICE_ALTERNATIVES, coarse._replace(routes=ALTERNATIVES)))
    if coarse.cell > BETWEEN * fine.cell:
        first.append((PRICE_FINE, searches.coarser(coarse._replace(cell=fine.cell, between=True))))
    fine = fine._replace(prove=searches.proves)
    return [
        *first,
        (PRICE_FINE if first else AT_ONCE, fine),
        *second,
        (PRICE_MANY if second else PRICE_ALTERNATIVES, fine._replace(cells=many, routes=ALTERNATIVES)),
        (PRICE_EXACT, fine._replace(cells=many, exact=True)),
        (PRICE_EXACT, fine._replace(cells=most, routes=ALTERNATIVES, exact=True)),
    ]
