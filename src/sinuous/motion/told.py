"""What is said of how a motion was found."""

from dataclasses import dataclass

from sinuous.solution.solution import Solution
from sinuous.solution.status import Status
from sinuous.solution.worst import Worst


@dataclass(frozen=True)
class Told:
    """What is said of how a motion was found.

    Attributes
    ----------
    solutions, waypoint_knots, reconfigured, remaining, seconds, method, seed
        As for `Motion`.
    ended : Status or None
        How it ended, where solutions and steps do not say it.
    blocking : Worst or None
        The constraint that is farthest from being met then.
    """

    solutions: tuple[Solution, ...] = ()
    waypoint_knots: tuple[int | None, ...] = ()
    reconfigured: tuple[int, ...] = ()
    remaining: int = 0
    seconds: float = 0.0
    method: str = "newton"
    seed: int = 0
    ended: Status | None = None
    blocking: Worst | None = None
