"""Trying changes within a time that is kept."""

from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.problem.problem import Problem
from sinuous.solution.again import Again
from sinuous.solution.binding import Binding
from sinuous.solution.reasons import Reason
from sinuous.solution.status import Status
from sinuous.words import rounded_up

if TYPE_CHECKING:
    from sinuous.solution.solution import Solution

QUICK = 24
"""Starts of a trial that only looks whether a change may do."""

FINE = 0.01
"""Share of a change to which the smallest is found."""

MORE = (1.0, 1.05, 1.2, 1.5, 2.0)
"""By how much a change is made larger where the whole search, begun anew, finds no solution with the smallest."""

Vary = Callable[[float], Problem]
"""Makes a problem in which something is changed by an amount greater than 0."""


class Case(NamedTuple):
    """The solve that failed.

    Attributes
    ----------
    problem : Problem
    status : Status
    q : ndarray (n, 3)
        The best configuration.
    given : ndarray (n, 3) or None
        The initial configuration of the user.
    binding : tuple of Binding
    reason : Reason or None
    again : Again
    starts : int
        How many starts were tried.
    """

    problem: Problem
    status: Status
    q: Floats
    given: Floats | None
    binding: tuple[Binding, ...]
    reason: Reason | None
    again: Again
    starts: int


class Trials:
    """Solves changed problems until the time is up; then nothing works any more.

    Parameters
    ----------
    case : Case
    seconds : float
        For all trials together.

    Attributes
    ----------
    complete : bool
        Whether no trial was cut short by the time.
    """

    def __init__(self, case: Case, seconds: float) -> None:
        self._case = case
        self._end = self._deadline = perf_counter() + seconds
        self.complete = True

    def share(self, others: int) -> None:
        """Give what comes next its part of the time that is left; so many others follow."""
        now = perf_counter()
        self._deadline = now + max(0.0, self._end - now) / (others + 1)

    @property
    def left(self) -> float:
        """Seconds that are left of this part."""
        return max(0.0, self._deadline - perf_counter())

    def quick(self, problem: Problem, initial: Floats | None = None) -> "Solution | None":
        """Return a solution from a given configuration, by default the best of the case, or a few starts."""
        near = self._case.q if initial is None else initial
        return self._solved(problem, near, routes=False, max_starts=min(QUICK, self._case.again.max_starts))

    def whole(self, problem: Problem, **options: Any) -> "Solution | None":
        """Return a solution that the whole search finds, begun as the user began it."""
        return self._solved(problem, self._case.given, **options)

    def _solved(self, problem: Problem, initial: Floats | None, **options: Any) -> "Solution | None":
        left = self.left
        if left <= 0.0:
            self.complete = False
            return None
        budget = options.pop("time", self._case.again.seconds)
        try:
            found = self._case.again.solve(problem, initial, time=min(budget, left), **options)
        except InputError:
            return None
        if not found.solved and left < budget and self.left <= 0.0:
            self.complete = False
        return found if found.solved else None

    def smallest(
        self, vary: Vary, first: float, most: float, thorough: bool = False
    ) -> tuple[float, "Solution"] | None:
        """Find the smallest amount, from `first` to `most`, by which something has to be changed; with its solution.

        Amounts are doubled until one works, then halved down to it. At last the whole search is run with it, as a user
        would. With `thorough` that is also done where a few starts find nothing.
        """
        low, high = 0.0, min(first, most)
        found = self.quick(vary(high))
        while found is None and high < most:
            low, high = high, min(2.0 * high, most)
            found = self.quick(vary(high))
        if found is None and thorough:
            low, found = 0.0, self.whole(vary(most))
        if found is None:
            return None
        while high - low > FINE * high and self.left > 0.0:
            middle = 0.5 * (low + high)
            tried = self.quick(vary(middle), found.q)
            if tried is None:
                low = middle
            else:
                high, found = middle, tried
        return self._confirmed(vary, high, most)

    def _confirmed(self, vary: Vary, amount: float, most: float) -> tuple[float, "Solution"] | None:
        for more in MORE:
            if self.left <= 0.0 or amount * more > most:
                return None
            told = min(most, rounded_up(amount * more))
            found = self.whole(vary(told))
            if found is not None:
                return told, found
        return None
