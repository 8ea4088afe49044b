"""Several solutions of one problem: distinct shapes, or one of every class of routes."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import monotonic
from typing import Literal

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import Outcome
from sinuous.problem.problem import Problem
from sinuous.solution.route_class import RouteClass
from sinuous.solving.classes.by_class import CANDIDATES, ByClass, Dislike
from sinuous.solving.classes.curves import Curves
from sinuous.solving.classes.explorer import Explorer
from sinuous.solving.classes.naming import name_classes, sort_out
from sinuous.solving.routing.searches import Searches
from sinuous.solving.search import Distinct
from sinuous.solving.starts import Batch, Question
from sinuous.solving.strategy import Passages, Strategy, opening

Kind = Literal["route", "shape"]
"""What may be asked for."""

KINDS: tuple[Kind, Kind] = ("route", "shape")
BY_ROUTE, BY_SHAPE = KINDS

SEARCHING = 0.8
"""Share of the time for the search among obstacles; the rest is for telling classes apart."""

FIRST = 0.5
"""Share of the time for the search, and of the starts, that a first solution may take."""


Strategies = Callable[[Question, Passages | None], Strategy]
"""Makes the strategy for a question, with routes through other passages if these are given."""


@dataclass(frozen=True)
class Wanted:
    """What several solutions are to be.

    Attributes
    ----------
    count : int
        Most of them.
    apart : float
        Solutions are the same when no point of the backbone is farther from its counterpart, in the length unit.
    by : str
        One of `KINDS`.
    max_starts : int
    seconds : float
    """

    count: int
    apart: float
    by: str
    max_starts: int
    seconds: float


class Several:
    """The search for several solutions of one problem; its time begins when it is made.

    Parameters
    ----------
    problem : Problem
    wanted : Wanted
    dislike : callable
    """

    def __init__(self, problem: Problem, wanted: Wanted, dislike: Dislike) -> None:
        self._wanted, self._dislike, self._end = wanted, dislike, math.inf
        compares = len(problem.scene) > 0 or wanted.by == BY_ROUTE
        self._curves = Curves(problem.robot, problem.scene, self._seconds_left) if compares else None
        if self._curves is not None:
            self._curves.load()

        def shape(q: Floats) -> Floats:
            return problem.robot.backbone(q, 8)

        shape(np.zeros((len(problem.robot), 3)))  # loads the kernel, before the time begins
        self._end = monotonic() + wanted.seconds
        seconds = wanted.seconds if self._curves is None else SEARCHING * wanted.seconds
        own = wanted.apart, shape, wanted.max_starts, seconds
        if self._curves is not None and wanted.by == BY_ROUTE:
            self.search: Distinct = ByClass(wanted.count, *own, self._curves, dislike)
        else:
            self.search = Distinct(CANDIDATES * wanted.count, *own)

    def batches(self, strategy: Strategies, searches: Searches | None, question: Question) -> Iterator[Batch]:
        """Yield the starts of `solve` up to a first solution, then those of a strategy for several.

        By route these have, before its routes, those through different passages, too.
        """
        yield opening(question, self._wanted.max_starts, searches is not None)
        if searches is not None and not self.search.found:
            yield from self._up_to_first(strategy, question._replace(several=False))
        passages = None
        if self._curves is not None and isinstance(self.search, ByClass) and searches is not None:
            passages = Explorer(searches, self._curves, self.search.has).batches
        yield from strategy(question, passages).batches()

    def _up_to_first(self, strategy: Strategies, question: Question) -> Iterator[Batch]:
        """Yield starts as `solve` follows them, one by one, until one is solved, or a share of time or starts is spent.

        What leads to one solution soonest is left out, or put off, where others are looked for beside it.
        """
        seconds, starts = (1.0 - FIRST) * question.seconds_left(), (1.0 - FIRST) * self.search.starts_left
        sooner = question._replace(seconds_left=lambda: question.seconds_left() - seconds)
        for batch in strategy(sooner, None).batches():
            for part in (batch,) if batch.closed is not None else batch.parts(lambda: 1):
                yield part
                if self.search.found or question.seconds_left() <= seconds or self.search.starts_left <= starts:
                    return

    def best(self) -> list[tuple[Outcome, RouteClass | None]]:
        """Return the solutions, best first, each with its class: `None` where that is not known."""
        count, curves = self._wanted.count, self._curves
        if isinstance(self.search, ByClass):
            found = self._ranked([members[0] for members in self.search.classes])
        else:
            found = self._ranked(self.search.found)[:count]
        if curves is None:
            return [(outcome, None) for outcome in found]
        tight = [curves.of(outcome.q) for outcome in found]
        same = sort_out(curves, tight)
        if isinstance(self.search, ByClass):
            kept = [i for i, first in enumerate(same) if i == first][:count]
            found, tight, same = [found[i] for i in kept], [tight[i] for i in kept], list(range(len(kept)))
        if self._seconds_left() <= 0.0:  # what was not compared any more seems to be different
            return [(outcome, None) for outcome in found]
        firsts = sorted(set(same))
        named = dict(zip(firsts, name_classes(curves, [tight[i] for i in firsts]), strict=True))
        return [(outcome, named[first]) for outcome, first in zip(found, same, strict=True)]

    def _ranked(self, found: list[Outcome]) -> list[Outcome]:
        order = np.argsort(self._dislike([outcome.q for outcome in found]), kind="stable")
        return [found[i] for i in order]

    def _seconds_left(self) -> float:
        return self._end - monotonic()
