"""All remedies in order: first what costs the user least."""

from sinuous.solution.remedies.effort import change_method, go_on
from sinuous.solution.remedies.limits import widen
from sinuous.solution.remedies.places import clear_away, free_the_base, make_thinner
from sinuous.solution.remedies.remedy import Remedy
from sinuous.solution.remedies.targets import drop, relax
from sinuous.solution.remedies.trials import Case, Trials
from sinuous.solution.status import Status

PROVED = (Status.OUT_OF_REACH, Status.TARGET_BLOCKED, Status.BASE_BLOCKED, Status.NO_ROUTE)
"""Statuses that no effort changes."""


def find_remedies(case: Case, seconds: float) -> tuple[tuple[Remedy, ...], bool]:
    """Return changes that work, and whether all were tried before the time was up."""
    trials = Trials(case, seconds)
    kinds = [widen, relax, clear_away, free_the_base, make_thinner, drop]
    if case.status not in PROVED:
        kinds = [change_method, *kinds, go_on]
    if case.status is Status.BASE_BLOCKED:  # nothing else can help
        kinds = [free_the_base, clear_away, make_thinner]
    found: list[Remedy] = []
    for i, kind in enumerate(kinds):
        trials.share(len(kinds) - 1 - i)
        found += kind(trials, case)
    return tuple(found), trials.complete
