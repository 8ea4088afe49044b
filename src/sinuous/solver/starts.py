"""Starts: the question that they are for, and batches of them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

from sinuous.base.checks import Floats
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
    cost : float
        What it took to make the batch, beside what its attempt takes anyway, in scattered starts.
    closed : float or None
        Edge of the cells by which it was proved that there is no route; `None` where nothing is proved.
    routes : tuple of ndarray (k, 3)
        Of every initial configuration the route that it was laid along; empty where they come from elsewhere.
    """

    source: str
    initial: Floats
    own: tuple[int, int] = (0, 0)
    cost: float = 0.0
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
