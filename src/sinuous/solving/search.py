"""One solve under way: the best so far, what it cost, and whether it goes on."""

import math

from sinuous.methods import registry as methods
from sinuous.solution.solution import Outcome


class Search:
    """Gathers what came of one batch of starts after the other.

    Parameters
    ----------
    first : Outcome
        Of the first batch.
    starts : int
        Most starts.
    seconds : float
        Budget.
    """

    def __init__(self, first: Outcome, starts: int, seconds: float) -> None:
        self._best = first
        self._starts, self._iterations, self._used = first.starts, first.iterations, first.seconds
        self._most, self._budget = starts, seconds

    @property
    def open(self) -> bool:
        """Whether nothing is decided yet, and starts and time are left."""
        undecided = self._best.code in (methods.FAILED, methods.UNPROVED)
        return undecided and self.starts_left > 0 and self.seconds_left > 0.0

    @property
    def starts_left(self) -> int:
        """How many starts may still be tried."""
        return self._most - self._starts

    @property
    def seconds_left(self) -> float:
        """What is left of the budget."""
        return self._budget - self._used

    @property
    def outcome(self) -> Outcome:
        """The best of all, with the effort of all."""
        best = self._best
        if best.code == methods.FAILED and self.seconds_left <= 0.0:
            best = best._replace(code=methods.LATE)
        return best._replace(starts=self._starts, iterations=self._iterations, seconds=self._used)

    def affordable(self, slice_seconds: float) -> int:
        """How many starts to try next: as many as before, if that takes no longer than `slice_seconds`."""
        quick = math.floor(slice_seconds * self._starts / max(self._used, 1e-9))
        return min(self.starts_left, max(1, min(self._starts, quick)))

    def spend(self, seconds: float) -> None:
        """Count time that went into something else than starts."""
        self._used += seconds

    def take(self, found: Outcome) -> None:
        """Count a batch, and keep what it found if it is better."""
        self._starts += found.starts
        self._iterations += found.iterations
        self._used += found.seconds
        if found.code == methods.SOLVED or found.merit < self._best.merit:
            self._best = found
        elif found.code == methods.LATE and self._best.code == methods.FAILED:
            self._best = self._best._replace(code=methods.LATE)

    def close(self, cell: float) -> None:
        """End it: with cubes of this edge it was proved that no way leads to the target."""
        self._best = self._best._replace(code=methods.NO_ROUTE, cell=cell)
