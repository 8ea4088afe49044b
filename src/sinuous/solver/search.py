"""One solve under way: what was found, what it cost, and whether it goes on. Two rules say when it stops."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator

from sinuous.base.work_time import work_time
from sinuous.kernels.tables import FAILED, LATE, NO_ROUTE, SOLVED, SOURCES, UNPROVED, Outcome
from sinuous.solver.attempts import StartBatch
from sinuous.solver.options import UNBOUNDED

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
