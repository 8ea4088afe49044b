"""More effort: another method, more starts, more time."""

from collections.abc import Iterator

from sinuous.solution.remedies.remedy import Remedy
from sinuous.solution.remedies.trials import Case, Trials
from sinuous.solution.status import Status

BEST = "newton"
"""The method that handles everything."""

TIMES = 10
"""How many times more starts are tried."""


def change_method(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield our own method, where another one failed."""
    if case.again.method != BEST and trials.whole(case.problem, method=BEST) is not None:
        yield Remedy("method", case.again.method, BEST)


def go_on(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield a longer budget, or more starts, where either ran out."""
    starts, seconds = case.again.max_starts, case.again.seconds
    if case.status is Status.TIME_LIMIT:
        longer = max(2.0 * seconds, 1e-3)
        while longer <= trials.left:
            if trials.whole(case.problem, time=longer) is not None:
                yield Remedy("time", seconds, longer)
                return
            longer *= 2.0
    elif case.starts >= starts and trials.whole(case.problem, max_starts=TIMES * starts) is not None:
        yield Remedy("max_starts", starts, TIMES * starts)
