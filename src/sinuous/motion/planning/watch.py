"""Counts the seconds of a plan, but for those of compiling."""

import time as clock
from collections.abc import Iterator
from contextlib import contextmanager


class Watch:
    """Counts the seconds of a plan, and says how many are left of a budget."""

    def __init__(self, budget: float) -> None:
        self._budget, self._began = budget, clock.perf_counter()

    def but_for(self, seconds: float) -> None:
        """Count so many seconds for what was done since the watch was made; the rest of it was compiling."""
        self._began = clock.perf_counter() - seconds

    @contextmanager
    def stopped(self) -> Iterator[None]:
        """Do not count what is done in the meantime: it compiles."""
        began = clock.perf_counter()
        try:
            yield
        finally:
            self._began += clock.perf_counter() - began

    @property
    def seconds(self) -> float:
        """Seconds until now."""
        return clock.perf_counter() - self._began

    def seconds_left(self) -> float:
        """What is left of the budget."""
        return self._budget - self.seconds
