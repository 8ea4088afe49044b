"""What to like better among all solutions."""

from dataclasses import dataclass
from typing import Self

from sinuous import checks
from sinuous.arguments import Number
from sinuous.frozen import Frozen


@dataclass(frozen=True, init=False, repr=False)
class Preferences(Frozen):
    """What to like better among all solutions; feasibility comes first, always.

    Parameters
    ----------
    start : float
        Weight of staying close to the start (bends in rad, lengths relative to their mean).
    bends : float
        Weight of small bends.
    clearance : float
        Clearance that is wished for, in the length unit; less than that is disliked.
    """

    start: float
    bends: float
    clearance: float

    def __init__(self, start: Number = 0.0, bends: Number = 0.0, clearance: Number = 0.0) -> None:
        for key, value in (("start", start), ("bends", bends), ("clearance", clearance)):
            self._set(**{key: checks.number(key, value, low=0.0)})

    def __bool__(self) -> bool:
        return self.start > 0.0 or self.bends > 0.0 or self.clearance > 0.0

    def beyond(self, demanded: float) -> Self:
        """Return the same where clearances count from the one that is demanded."""
        if demanded == 0.0 or self.clearance == 0.0:
            return self
        return type(self)(self.start, self.bends, max(0.0, self.clearance - demanded))

    def satisfied(self, clearance: float) -> bool:
        """Say whether a solution with this clearance cannot be better: there is enough, and nothing else is wished."""
        return self.start == self.bends == 0.0 and clearance >= self.clearance
