"""Several solutions of one problem: distinct shapes, or one of every class of routes."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from sinuous.answer.route_class import RouteClass
from sinuous.base.checks import Floats
from sinuous.base.progress import work_time
from sinuous.kernels.tables import OUT_OF_REACH, ROUTE, SOLVED, Outcome
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.solver.attempts import Clock, Deadline, IKQuery, RandomRestarts, Search, StartBatch
from sinuous.solver.certificates.steps import LoadedShapes
from sinuous.solver.route_classes.curves import RouteCurves, group_alike, name_classes
from sinuous.solver.route_classes.passages import Passages
from sinuous.solver.strategy import Strategy
from sinuous.statics.equilibrium import longest_body

Kind = Literal["route", "shape"]
"""What may be asked for."""

KINDS: tuple[Kind, Kind] = ("route", "shape")
BY_ROUTE, BY_SHAPE = KINDS

SEARCHING = 0.8
"""Share of the time for the search among obstacles; the rest is for telling classes apart."""

FIRST = 0.5
"""Share of the time for the search, and of the starts, that a first solution may take."""

PATIENCE = 1000
"""Starts in a row, routes not counted, that bring nothing new after the first solution, before the search stops."""

CLASS_PATIENCE = 400
"""The same where classes are wanted: starts in a row that bring no new class."""

CANDIDATES = 4
"""Distinct solutions of a class that are kept, the best ones."""

PreferenceCost = Callable[[list[Floats]], Floats]
"""A number (m,) for each of m configurations (n, 3): what is smaller is better."""


Body = Callable[[Floats], Floats]
"""The configuration of the body, of one (n, 3) of the robot: the same, or arcs (N, 3) of a loaded one."""


def preference_cost(robot: Robot, reference: Floats | None) -> PreferenceCost:
    """Return by what several solutions are ordered: how much they bend, or how far they are from a reference (n, 3).

    That is the sum of squared bends (rad), or of squared differences, lengths in mean lengths of a segment.
    """

    def dislike(found: list[Floats]) -> Floats:
        q = np.array(found).reshape(-1, len(robot), 3)
        if reference is None:
            return np.asarray((q[..., :2] ** 2).sum(axis=(1, 2)))
        units = 1.0, 1.0, robot.mean_length / len(robot)
        return np.asarray((((q - reference) / units) ** 2).sum(axis=(1, 2)))

    return dislike


@dataclass(frozen=True)
class DistinctOptions:
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


class RouteClasses:
    """Solutions by their classes of routes, of each the best ones.

    Parameters
    ----------
    curves : RouteCurves
    count : int
        Classes that are wanted.
    dislike : callable
    body : callable
        The configuration of the body that curves are of, for one (n, 3) of the robot.

    Attributes
    ----------
    members : list of list of Outcome
        Of every class the best solutions, best first.
    """

    def __init__(self, curves: RouteCurves, count: int, dislike: PreferenceCost, body: Body = lambda q: q) -> None:
        self._curves, self._body, self._count, self._dislike = curves, body, count, dislike
        self._firsts: list[Floats] = []
        self.members: list[list[Outcome]] = []

    @property
    def enough(self) -> bool:
        """Whether there are as many as are wanted."""
        return len(self.members) >= self._count

    def has(self, curve: Floats) -> bool:
        """Whether there is a solution of the class of a curve (N, 3)."""
        return self._curves.alike_one(curve, self._firsts) is not None

    def add(self, found: Outcome, deadline: Deadline) -> bool:
        """Put a solution among the best of its class; return whether the class is new."""
        curve = self._curves.of(self._body(found.q))
        number = self._curves.alike_one(curve, self._firsts)
        if number is not None:
            members = [*self.members[number], found]
            order = np.argsort(self._dislike([each.q for each in members]), kind="stable")
            self.members[number] = [members[i] for i in order[:CANDIDATES]]
            return False
        if deadline() <= 0.0:  # comparing took too long to say that it is new
            return False
        self._firsts.append(curve)
        self.members.append([found])
        return True


class DistinctSearch(Search):
    """Follows every start to its own solution, and stops when enough distinct ones are found, or no more seem left.

    Parameters
    ----------
    count : int
        Distinct solutions to find.
    apart : float
        Two solutions are the same when no point of the backbone is farther from its counterpart, in the length unit.
    shape : callable
        Points (k, 3) of the backbone of a configuration (n, 3).
    max_starts, seconds, clock
        See `Search`.
    classes : RouteClasses, optional
        Where classes are wanted, too.

    Attributes
    ----------
    found : list of Outcome
        Distinct, all solved, in the order in which they were found; each with the effort until then.
    """

    def __init__(
        self,
        count: int,
        apart: float,
        shape: Callable[[Floats], Floats],
        max_starts: int,
        seconds: float,
        clock: Clock = work_time,
        classes: RouteClasses | None = None,
    ) -> None:
        super().__init__(max_starts, seconds, clock)
        self._count, self._apart, self._shape, self.classes = count, apart, shape, classes
        self._patience = PATIENCE if classes is None else CLASS_PATIENCE
        self._shapes: list[Floats] = []
        self._impossible, self._in_vain = False, 0
        self.found: list[Outcome] = []

    @property
    def open(self) -> bool:
        """Whether more is wanted and possible, there is hope for it, and starts and time are left."""
        enough = len(self.found) >= self._count and (self.classes is None or self.classes.enough)
        hope = not self._impossible and self._in_vain < self._patience
        return not enough and hope and self.starts_left > 0 and self.seconds_left > 0.0

    def chunk(self) -> int:
        """One: a call ends with its first solution."""
        return 1

    def keep(self, found: Outcome) -> None:
        """Keep a solution that differs from all before."""
        self._impossible = found.code >= OUT_OF_REACH
        if found.source != ROUTE and self.found:
            self._in_vain += found.starts
        if found.code != SOLVED:
            return
        shape = self._shape(found.q)
        if self._shapes and (_distances(np.array(self._shapes), shape) <= self._apart).any():
            return
        self._shapes.append(shape)
        self.found.append(found._replace(starts=self._starts, iterations=self._iterations, seconds=self.seconds_used))
        if self.classes is None or self.classes.add(self.found[-1], lambda: self.seconds_left):
            self._in_vain = 0

    def close(self, cell: float) -> None:
        """End it: no route leads to the target, so there are no more solutions."""
        self._impossible = True


def _distances(shapes: Floats, shape: Floats) -> Floats:
    """Largest distance (m,) between counterparts of shapes (m, k, 3) and one shape (k, 3)."""
    return np.linalg.norm(shapes - shape, axis=-1).max(axis=-1)


class DistinctSolutions:
    """The search for several solutions of one problem; its time begins when it is made.

    Parameters
    ----------
    problem : Problem
    wanted : DistinctOptions
    dislike : callable
    """

    def __init__(self, problem: Problem, wanted: DistinctOptions, dislike: PreferenceCost) -> None:
        self._wanted, self._dislike, self._end = wanted, dislike, math.inf
        compares = len(problem.scene) > 0 or wanted.by == BY_ROUTE
        robot = problem.robot
        ways = LoadedShapes(robot) if robot.has_external_load else None
        body = robot if ways is None else longest_body(robot)
        self._body: Body = (lambda q: q) if ways is None else lambda q: ways.at(q).arcs
        self._curves = RouteCurves(body, problem.scene, self._seconds_left) if compares else None
        if self._curves is not None:
            self._curves.load()

        def shape(q: Floats) -> Floats:
            return body.backbone(self._body(q), 8)

        body.backbone(np.zeros((len(body), 3)), 8)  # loads the kernel, before the time begins
        self._end = work_time() + wanted.seconds
        seconds = wanted.seconds if self._curves is None else SEARCHING * wanted.seconds
        classes = None
        if self._curves is not None and wanted.by == BY_ROUTE:
            classes = RouteClasses(self._curves, wanted.count, dislike, self._body)
        count = CANDIDATES * wanted.count
        self.search = DistinctSearch(count, wanted.apart, shape, wanted.max_starts, seconds, classes=classes)

    def batches(self, strategy: Strategy, question: IKQuery) -> Iterator[StartBatch]:
        """Yield the starts of `solve` up to a first solution, then those of the strategy for several.

        By route these have, before its routes, those through different passages, too.
        """
        searches, scattered = strategy.searches, strategy.random_restarts(question)
        yield strategy.opening(question)
        if searches is not None and not self.search.found:
            yield from self._for_one(strategy, question._replace(several=False), scattered)
        passages = None
        if self._curves is not None and self.search.classes is not None and searches is not None:
            passages = partial(Passages, searches, self._curves, solved=self.search.classes.has)
        yield from strategy.batches(question, scattered, passages)

    def _for_one(self, strategy: Strategy, question: IKQuery, scattered: RandomRestarts) -> Iterator[StartBatch]:
        """Yield starts as `solve` follows them, one by one, until one is solved, or a share of time or starts is spent.

        What leads to one solution soonest is left out, or put off, where others are looked for beside it.
        """
        seconds, starts = (1.0 - FIRST) * question.deadline(), (1.0 - FIRST) * self.search.starts_left
        sooner = question._replace(deadline=lambda: question.deadline() - seconds)
        for batch in strategy.batches(sooner, scattered):
            for part in (batch,) if batch.closed is not None else batch.parts(lambda: 1):
                yield part
                if self.search.found or question.deadline() <= seconds or self.search.starts_left <= starts:
                    if part.source == RandomRestarts.name:
                        scattered.continue_from(part.own[1])
                    return

    def best(self) -> list[tuple[Outcome, RouteClass | None]]:
        """Return the solutions, best first, each with its class: `None` where that is not known."""
        count, curves = self._wanted.count, self._curves
        classes = self.search.classes
        if classes is None:
            found = self._ranked(self.search.found)[:count]
        else:
            found = self._ranked([members[0] for members in classes.members])
        if curves is None:
            return [(outcome, None) for outcome in found]
        tight = [curves.of(self._body(outcome.q)) for outcome in found]
        same = group_alike(curves, tight)
        if classes is not None:
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
        return self._end - work_time()
