"""One solve under way: what was found, what it cost, and whether it goes on. Two rules say when it stops."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import FAILED, LATE, NO_ROUTE, OUT_OF_REACH, ROUTE, SOLVED, SOURCES, UNPROVED, Outcome
from sinuous.solving.sources import Batch

SLICE = 0.1
"""Seconds after which a method should return to Python, so that an interrupt is seen."""

UNDECIDED = (FAILED, UNPROVED)
"""How a call ends after which a search goes on."""

Follow = Callable[[Batch, float], Outcome]
"""Follows the starts of a batch, for at most so many seconds, until one is solved."""


class Search(ABC):
    """Counts starts, iterations and seconds; a stopping rule is what subclasses add.

    Parameters
    ----------
    max_starts : int
        Most starts.
    seconds : float
        Budget.
    """

    def __init__(self, max_starts: int, seconds: float) -> None:
        self._max_starts, self._budget = max_starts, seconds
        self._starts = self._iterations = 0
        self._used = 0.0

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
        return self._budget - self._used

    def take(self, found: Outcome) -> None:
        """Count what came of one call, and look at it."""
        self._starts += found.starts
        self._iterations += found.iterations
        self._used += found.seconds
        self.keep(found)

    def pursue(self, batches: Iterator[Batch], follow: Follow) -> None:
        """Follow batch after batch while the search is open; the next batch is asked for only then."""
        while self.open:
            batch = next(batches, None)
            if batch is None:
                return
            self._used += batch.seconds
            if batch.closed is not None:
                self.close(batch.closed)
            for part in batch.parts(self.chunk):
                if not self.open:
                    return
                found = follow(part, self.seconds_left)
                if batch.source == SOURCES[ROUTE]:
                    found = found._replace(source=ROUTE)
                self.take(found)
                if found.starts == 0:  # the method has no more of its own
                    break


class FirstSolved(Search):
    """Stops at the first solution or proof; keeps the best of all.

    Parameters
    ----------
    first : Outcome
        Of the first call.
    max_starts, seconds
        See `Search`.
    """

    def __init__(self, first: Outcome, max_starts: int, seconds: float) -> None:
        super().__init__(max_starts, seconds)
        self._best = first
        self.take(first)

    @property
    def open(self) -> bool:
        """Whether nothing is decided yet, and starts and time are left."""
        return self._best.code in UNDECIDED and self.starts_left > 0 and self.seconds_left > 0.0

    def chunk(self) -> int:
        """As many as before, if that takes no longer than `SLICE`."""
        quick = math.floor(SLICE * self._starts / max(self._used, 1e-9))
        return min(self.starts_left, max(1, min(self._starts, quick)))

    def keep(self, found: Outcome) -> None:
        """Keep it if it is better: solved, or met as far as could be seen, or nearer to that."""
        if _rank(found) < _rank(self._best):
            self._best = found
        elif found.code == LATE and self._best.code == FAILED:
            self._best = self._best._replace(code=LATE)

    def close(self, cell: float) -> None:
        """End it: no route leads to the target."""
        self._best = self._best._replace(code=NO_ROUTE, cell=cell)

    @property
    def outcome(self) -> Outcome:
        """The best of all, with the effort of all."""
        best = self._best
        if best.code == FAILED and self.seconds_left <= 0.0:
            best = best._replace(code=LATE)
        return best._replace(starts=self._starts, iterations=self._iterations, seconds=self._used)


def _rank(outcome: Outcome) -> tuple[int, float]:
    """What is smaller is better. A start that met everything but the proof is better than one that did not."""
    return {SOLVED: 0, UNPROVED: 1}.get(outcome.code, 2), outcome.merit


class Distinct(Search):
    """Follows every start to its own solution, and stops when so many distinct ones are found, or none can be.

    Parameters
    ----------
    count : int
        Distinct solutions to find.
    apart : float
        Two solutions are the same when no point of the backbone is farther from its counterpart, in the length unit.
    shape : callable
        Points (k, 3) of the backbone of a configuration (n, 3).
    max_starts, seconds
        See `Search`.

    Attributes
    ----------
    found : list of Outcome
        Distinct, all solved, in the order in which they were found; each with the effort until then.
    """

    def __init__(
        self, count: int, apart: float, shape: Callable[[Floats], Floats], max_starts: int, seconds: float
    ) -> None:
        super().__init__(max_starts, seconds)
        self._count, self._apart, self._shape = count, apart, shape
        self._shapes: list[Floats] = []
        self._impossible = False
        self.found: list[Outcome] = []

    @property
    def open(self) -> bool:
        """Whether solutions are missing and possible, and starts and time are left."""
        wanted = len(self.found) < self._count and not self._impossible
        return wanted and self.starts_left > 0 and self.seconds_left > 0.0

    def chunk(self) -> int:
        """One: a call ends with its first solution."""
        return 1

    def keep(self, found: Outcome) -> None:
        """Keep a solution that differs from all before."""
        self._impossible = found.code >= OUT_OF_REACH
        if found.code != SOLVED:
            return
        shape = self._shape(found.q)
        if all(np.linalg.norm(shape - other, axis=-1).max() > self._apart for other in self._shapes):
            self._shapes.append(shape)
            self.found.append(found._replace(starts=self._starts, iterations=self._iterations, seconds=self._used))

    def close(self, cell: float) -> None:
        """End it: no route leads to the target, so there are no more solutions."""
        self._impossible = True
