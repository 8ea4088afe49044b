"""More effort: another method, more starts, more time."""

import math
from collections.abc import Iterator

from sinuous.solution.remedies.remedy import Remedy
from sinuous.solution.remedies.trials import Case, Trials
from sinuous.solution.status import Status
from sinuous.words import rounded_up

BEST = "newton"
"""The method that handles everything."""

TIMES = 10
"""How many times more starts are tried."""

MOST, FINE = 1024.0, 1.01
"""How many times larger changes are tried, and how closely the smallest is found."""


def change_method(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield our own method, where another one failed."""
    if case.again.method != BEST and trials.whole(case.problem, method=BEST) is not None:
        yield Remedy("method", case.again.method, BEST)


def allow_more(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield larger changes, all by the same factor, where changes were what was allowed."""
    assert case.within is not None
    low, high = 1.0, 2.0
    while trials.whole(case.problem, within=case.within * high) is None:
        low, high = high, 2.0 * high
        if high > MOST:
            return
    while high > FINE * low and trials.may_refine():
        middle = math.sqrt(low * high)
        if trials.whole(case.problem, within=case.within * middle) is None:
            low = middle
        else:
            high = middle
    told = rounded_up(high)
    if trials.whole(case.problem, within=case.within * told) is not None:
        yield Remedy("within", 1.0, told, "times the changes that were allowed")


def go_on(trials: Trials, case: Case) -> Iterator[Remedy]:
    """Yield a longer budget, or more starts, where either ran out."""
    starts, seconds = case.again.max_starts, case.again.seconds
    if case.status is Status.TIME_LIMIT or starts is None:
        longer = max(2.0 * seconds, 1e-3)
        while longer <= trials.left:
            if trials.whole(case.problem, time=longer, max_starts=starts) is not None:
                yield Remedy("time", seconds, longer)
                return
            longer *= 2.0
    elif case.starts >= starts and trials.whole(case.problem, max_starts=TIMES * starts) is not None:
        yield Remedy("max_starts", starts, TIMES * starts)
