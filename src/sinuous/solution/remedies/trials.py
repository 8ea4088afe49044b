"""Trying changes within a time that is kept."""

from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.problem.problem import Problem
from sinuous.robot.rates import Changes
from sinuous.solution.again import Again
from sinuous.solution.binding.binding import Binding
from sinuous.solution.reasons import Reason
from sinuous.solution.status import Status
from sinuous.words import rounded_up

if TYPE_CHECKING:
    from sinuous.solution.solution import Solution

QUICK = 24
"""Starts of a trial that only looks whether a change may do."""

STARTS = 1000
"""Most starts of a trial, where the user gave no bound."""

FINE = 0.01
"""Share of a change to which the smallest is found."""

SMALLER = 3.0
"""By how much a change is made smaller at first."""

LOOKS = 3
"""How often it is made smaller before it is given up, where it does not work."""

REFINING = 0.6
"""Share of the time after which nothing is made smaller any more."""

NOTHING = 1e-4
"""Share of the largest change below which it is not made smaller."""

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
    within : Changes or None
        The changes from there that were allowed.
    """

    problem: Problem
    status: Status
    q: Floats
    given: Floats | None
    binding: tuple[Binding, ...]
    reason: Reason | None
    again: Again
    starts: int
    within: Changes | None = None


class Trials:
    """Solves changed problems until the time is up; then nothing works any more.

    Parameters
    ----------
    case : Case
    end : float
        When the time is up, by `time.perf_counter`.

    Attributes
    ----------
    complete : bool
        Whether no trial was cut short by the time.
    """

    def __init__(self, case: Case, end: float) -> None:
        self._case = case
        self._end = self._deadline = self._refined = end
        self.complete = True

    def share(self, part: float) -> None:
        """Give what comes next this part of the time that is left."""
        now = perf_counter()
        self._deadline = now + max(0.0, self._end - now) * part
        self._refined = now + REFINING * (self._deadline - now)

    def may_refine(self) -> bool:
        """Whether what was found may still be made smaller; later, there would be no time left to confirm it."""
        early = perf_counter() < self._refined
        self.complete &= early
        return early

    @property
    def left(self) -> float:
        """Seconds that are left of this part."""
        return max(0.0, self._deadline - perf_counter())

    def quick(self, problem: Problem, initial: Floats | None = None) -> "Solution | None":
        """Return a solution from a given configuration, by default the best of the case, or a few starts."""
        near = self._case.q if initial is None else initial
        return self._solved(problem, near, routes=False, max_starts=min(QUICK, self._most_starts))

    def whole(self, problem: Problem, **options: Any) -> "Solution | None":
        """Return a solution that the whole search finds, begun as the user began it."""
        return self._solved(problem, self._case.given, **{"max_starts": self._most_starts, **options})

    @property
    def _most_starts(self) -> int:
        """Most starts of a trial: a search without a bound would take all the time that is left for others."""
        own = self._case.again.max_starts
        return STARTS if own is None else own

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

    def smallest(self, vary: Vary, most: float, thorough: bool = False) -> tuple[float, "Solution"] | None:
        """Find the smallest amount, up to `most`, by which something has to be changed; with its solution.

        A few large changes come first: where all fail, nothing else is tried. Then the change is made smaller as long
        as that works, each time from the last solution. At last the whole search is run with it, as a user would. With
        `thorough` that is also done where a few starts find nothing.
        """
        high, found = most, self.quick(vary(most))
        while found is None and high > most / SMALLER**LOOKS:
            high /= SMALLER
            found = self.quick(vary(high))
        if found is None and thorough:
            high, found = most, self.whole(vary(most))
        if found is None:
            return None
        low = 0.0
        while high - low > FINE * high and self.may_refine():
            middle = max(high / SMALLER, 0.5 * (low + high)) if low > 0.0 else high / SMALLER
            tried = self.quick(vary(middle), found.q)
            if tried is None:
                low = middle
            else:
                high, found = middle, tried
            if high < NOTHING * most:
                break
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
