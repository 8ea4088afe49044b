"""What is tried for a query: its starts, the queue of attempts, and the search that follows it until it is decided."""

import heapq
from abc import ABC, abstractmethod
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import count
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.progress import work_time
from sinuous.kernels.tables import FAILED, LATE, NO_ROUTE, RANDOM, SOLVED, SOURCES, UNPROVED, Outcome
from sinuous.problem.problem import Problem
from sinuous.solver.options import SCATTERED, UNBOUNDED

Deadline = Callable[[], float]
"""When a solve has to end: says how many seconds are left until then. It ends what makes starts, see `ending`."""


class TimeUp(Exception):  # noqa: N818 - no error
    """Nothing that is made from here on would be followed: no time is left."""


def ending(deadline: Deadline) -> Deadline:
    """Return the same deadline, which raises `TimeUp` for who asks it when no time is left."""

    def left() -> float:
        seconds = deadline()
        if seconds <= 0.0:
            raise TimeUp
        return seconds

    return left


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


ROUND = 64
"""Scattered starts of the first batch when nothing else is left to be tried; each following batch has twice as many."""

EFFORT_OF_A_CHAIN = 1
"""Effort of a start that is given, in scattered starts, beside that of its attempt."""


class Attempt(NamedTuple):
    """Something to be tried: smaller comes first.

    Attributes
    ----------
    priority : float
        Of all attempts the one with the least priority comes next.
    number : int
        Of those with the same priority, the one that was added first.
    name : str
        One of `options.ATTEMPTS`.
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


class AttemptsBeyond:
    """The same queue for attempts that make starts of what is left of a robot, beyond its first rows.

    Parameters
    ----------
    queue : AttemptQueue
    root : ndarray (k, 3)
        How the first rows stand: starts get them in front.
    later : float
        What is added to the priority of each attempt.
    """

    def __init__(self, queue: AttemptQueue, root: Floats, later: float) -> None:
        self._queue, self._root, self._later = queue, root, later
        self.without = queue.without

    def add(
        self, name: str, priority: float, make: Callable[[], Iterator[StartBatch]], effort: float | None = None
    ) -> None:
        """Add an attempt, as `AttemptQueue.add` does."""
        effort = priority if effort is None else effort
        self._queue.add(name, self._later + priority, partial(self._whole, make), effort)

    def restart_batch(self, count: int) -> StartBatch:
        """Return the next so many scattered starts of the whole robot."""
        return self._queue.restart_batch(count)

    def _whole(self, make: Callable[[], Iterator[StartBatch]]) -> Iterator[StartBatch]:
        for batch in make():
            roots = np.broadcast_to(self._root, (len(batch.initial), *self._root.shape))
            yield replace(batch, initial=np.concatenate([roots, batch.initial], axis=1), closed=None)


ENOUGH = 1000
"""Starts of a search that the user does not bound, after which its end says what the best found lacks: before that it
says that there was no more time."""

UNDECIDED = (FAILED, UNPROVED)
"""How a call ends after which a search goes on."""

Follow = Callable[[StartBatch, float], Outcome]
"""Follows the starts of a batch, for at most so many seconds, until one is solved."""

Clock = Callable[[], float]
"""Seconds since any moment."""


class Search(ABC):
    """Counts starts, iterations and seconds; a stopping rule is what subclasses add.

    The budget is one of time on the wall, from when the search is made: what happens between two calls is in it.

    Parameters
    ----------
    max_starts : int
        Most starts.
    seconds : float
        Budget.
    clock : callable
    """

    def __init__(self, max_starts: int, seconds: float, clock: Clock = work_time) -> None:
        self._max_starts, self._budget, self._clock = max_starts, seconds, clock
        self._starts = self._iterations = 0
        self._began = clock()

    @property
    @abstractmethod
    def open(self) -> bool:
        """Whether it goes on."""

    @abstractmethod
    def chunk(self) -> int:
        """How many starts to follow next, in one call."""

    @abstractmethod
    def keep(self, found: Outcome) -> None:
        """Look at what came of one call."""

    @abstractmethod
    def close(self, cell: float) -> None:
        """Take notice that there is no route, proved with cells of this edge."""

    @property
    def starts_left(self) -> int:
        """How many starts may still be tried."""
        return self._max_starts - self._starts

    @property
    def seconds_left(self) -> float:
        """What is left of the budget."""
        return self._budget - self.seconds_used

    @property
    def seconds_used(self) -> float:
        """What is used of the budget."""
        return self._clock() - self._began

    def take(self, found: Outcome) -> None:
        """Count what came of one call, and look at it."""
        self._starts += found.starts
        self._iterations += found.iterations
        self.keep(found)

    def pursue(self, batches: Iterator[StartBatch], follow: Follow) -> None:
        """Follow batch after batch while the search is open; the next batch is asked for only then."""
        while self.open:
            batch = next(batches, None)
            if batch is None:
                return
            if batch.closed is not None:
                self.close(batch.closed)
            for part in batch.parts(self.chunk):
                if not self.open:
                    return
                found = follow(part, self.seconds_left)
                if len(part.initial):
                    solved = found.code == SOLVED and len(part.routes) > 0
                    route = part.routes[found.starts - 1] if solved else None
                    found = found._replace(source=SOURCES.index(batch.source), route=route)
                self.take(found)
                if found.starts == 0:  # the method has no more of its own
                    return


class FirstSolved(Search):
    """Stops at the first solution or proof; keeps the best of all.

    Parameters
    ----------
    first : Outcome
        Of the first call, whose seconds are off the budget.
    max_starts : int, optional
        Most starts; by default as many as the time allows.
    seconds, clock
        See `Search`.
    """

    def __init__(self, first: Outcome, max_starts: int | None, seconds: float, clock: Clock = work_time) -> None:
        super().__init__(UNBOUNDED if max_starts is None else max_starts, seconds, clock)
        self._began -= first.seconds
        self._best, self._late, self._enough = first, False, ENOUGH if max_starts is None else max_starts
        self.take(first)

    @property
    def open(self) -> bool:
        """Whether nothing is decided yet, and starts and time are left."""
        undecided = self._best.code in UNDECIDED and not self._late
        return undecided and self.starts_left > 0 and self.seconds_left > 0.0

    def chunk(self) -> int:
        """As many as before."""
        return min(self.starts_left, max(1, self._starts))

    def keep(self, found: Outcome) -> None:
        """Keep it if it is better: solved, or met as far as could be seen, or nearer to that."""
        if found.code == LATE:
            self._late, found = True, found._replace(code=FAILED)
        if _rank(found) < _rank(self._best):
            self._best = found

    def close(self, cell: float) -> None:
        """End it: no route leads to the target."""
        self._best = self._best._replace(code=NO_ROUTE, cell=cell)

    @property
    def outcome(self) -> Outcome:
        """The best of all, with the effort of all."""
        best = self._best
        if best.code == FAILED and (self._late or self.seconds_left <= 0.0) and self._starts < self._enough:
            best = best._replace(code=LATE)
        return best._replace(starts=self._starts, iterations=self._iterations, seconds=self.seconds_used)


def _rank(outcome: Outcome) -> tuple[int, float]:
    """What is smaller is better. A start that met everything but the proof is better than one that did not."""
    return {SOLVED: 0, UNPROVED: 1}.get(outcome.code, 2), outcome.merit
