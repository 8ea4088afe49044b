"""How a solution solves again: what it keeps of the solver that found it."""

from dataclasses import dataclass, field
from typing import Any, Protocol

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.robot import Robot
from sinuous.problem.problem import Preferences, Problem


class FoundSolution(Protocol):
    """What a solve returns: a `Solution`."""

    @property
    def solved(self) -> bool:
        """Whether it is solved and proved."""
        ...

    @property
    def configuration(self) -> Floats:
        """Configuration (rows, 3) of joints and segments."""
        ...


@dataclass(frozen=True)
class SolveAgain:
    """Solves problems with the options of an earlier solve; small, and can be pickled.

    Attributes
    ----------
    method : str
    seed : int
        Of the scattered starts.
    seconds : float
        Budget of a solve.
    max_starts : int or None
        Most starts of a solve; `None`: as many as the time allows.
    preferences : Preferences
        What answers are chosen by; none: they are the nearest.
    """

    method: str
    seed: int
    seconds: float = 0.0
    max_starts: int | None = 0
    preferences: Preferences = field(default_factory=Preferences)

    def chooses(self, robot: Robot, clearance: float) -> bool:
        """Whether answers with this proved clearance are not merely the nearest.

        They are chosen by preferences, or moved out of contact.
        """
        raise NotImplementedError

    def solve(self, problem: Problem, initial: Floats | None = None, **options: Any) -> FoundSolution:
        """Solve a problem from the configuration `initial` (n, 3); `options` replace those of the earlier solve.

        Among them may be `within`: the changes from there that are allowed.
        """
        raise NotImplementedError


class UnknownOptions(SolveAgain):
    """Stands in where a solution was read from a file, which does not say with which options it was found."""

    def chooses(self, robot: Robot, clearance: float) -> bool:
        """Return False: how they were chosen is not known."""
        return False

    def solve(self, problem: Problem, initial: Floats | None = None, **options: Any) -> FoundSolution:
        """Refuse: see the class."""
        raise InputError(
            "solution",
            "was read from a file, which does not say its options",
            self.method,
            "one that was solved in this process",
        )
