"""All remedies in order: first what costs the user least."""

from collections.abc import Callable, Iterator

from sinuous.solution.remedies.effort import allow_more, change_method, go_on
from sinuous.solution.remedies.limits import widen
from sinuous.solution.remedies.places import clear_away, free_the_base, let_through, make_thinner
from sinuous.solution.remedies.remedy import Remedy
from sinuous.solution.remedies.targets import drop, relax
from sinuous.solution.remedies.trials import Case, Trials
from sinuous.solution.status import Status

Kind = Callable[[Trials, Case], Iterator[Remedy]]

PROVED = (Status.OUT_OF_REACH, Status.TARGET_BLOCKED, Status.BASE_BLOCKED, Status.NO_ROUTE)
"""Statuses that no effort changes."""


KINDS = (
    (change_method, 2.0),
    (widen, 3.0),
    (relax, 3.0),
    (clear_away, 3.0),
    (free_the_base, 1.0),
    (make_thinner, 1.0),
    (let_through, 1.0),
    (drop, 1.0),
    (go_on, 1.0),
)
"""Kinds of remedies, and the shares of the time that they may take; what one leaves is for those after it."""

OF_THE_BASE = (free_the_base, clear_away, make_thinner)
"""What can help where the base is blocked."""


def find_remedies(case: Case, end: float) -> tuple[tuple[Remedy, ...], bool]:
    """Return changes that work, and whether all were tried before `end` (by `time.perf_counter`)."""
    trials = Trials(case, end)
    kinds: list[tuple[Kind, float]] = [pair for pair in KINDS if _can_help(pair[0], case.status)]
    if case.within is not None:  # all others begin anywhere, and go anywhere
        kinds = [(allow_more, 1.0)]
    found: list[Remedy] = []
    for i, (kind, part) in enumerate(kinds):
        trials.share(part / sum(other for _, other in kinds[i:]))
        found += kind(trials, case)
    return tuple(found), trials.complete


def _can_help(kind: Kind, status: Status) -> bool:
    if status is Status.BASE_BLOCKED:
        return kind in OF_THE_BASE
    return status not in PROVED or kind not in (change_method, go_on)
