"""How a solution solves again: what it keeps of the solver that found it; and how one is read from plain values."""

import math
from dataclasses import dataclass, field
from typing import Any, Protocol

from sinuous.answer.route_class import RouteClass
from sinuous.answer.status import CODES, Status
from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels import tables as t
from sinuous.model.robot import Robot, demanding
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
    """Solves problems with the options of an earlier solve, where they are known; small, and can be pickled.

    A file of a solution does not say them: then this stands in, and refuses.

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
        """Whether answers with this proved clearance are not merely the nearest, as far as that is known.

        They are chosen by preferences, or moved out of contact.
        """
        return False

    def solve(self, problem: Problem, initial: Floats | None = None, **options: Any) -> FoundSolution:
        """Solve a problem from the configuration `initial` (n, 3); `options` replace those of the earlier solve.

        Among them may be `within`: the changes from there that are allowed.
        """
        raise InputError(
            "solution",
            "was read from a file, which does not say its options",
            self.method,
            "one that was solved in this process",
        )


_STATUSES = tuple(status for status in Status if status not in (Status.START_BLOCKED, Status.LEFT_PATH))
"""What a solve may end with; motions alone can be blocked at their start, or leave their path."""


def read_result(values: Any, problem: Problem) -> tuple[t.Outcome, SolveAgain, RouteClass | None]:
    """Read the result of a problem, as `Solution.to_dict` writes it; keys that are not needed are not looked at.

    Raises
    ------
    InputError
        When a key is missing or its value cannot be meant.
    """
    result = Entries(values)
    status, start = result.choice("status", _STATUSES), result.choice("start", t.SOURCES)
    clearance = result.optional("clearance")
    robot, given = problem.robot, result.value("q")
    whole = robot.configuration("q", given, result.value("joints")) if robot.joints else given
    q = checks.array("q", whole, (len(robot), 3)).copy()
    outcome = t.Outcome(
        q,
        CODES.get(Status(status), t.FAILED),
        result.integer("iterations", 2**62),
        result.integer("starts", 2**62),
        t.SOURCES.index(start),
        _or(result.optional("position_error"), math.nan),
        _or(result.optional("angle_error"), math.nan),
        -math.inf if status == Status.BLOCKED else _or(clearance, math.inf) - problem.robot._least_clearances[0],
        _or(result.optional("self_clearance"), math.inf) - problem.robot._least_clearances[1],
        status == Status.LIMIT_BOUND,
        math.nan,
        result.number("seconds"),
        _cell(result) if status == Status.NO_ROUTE else math.nan,
    )
    resolver = SolveAgain(result.text("method"), result.integer("seed", 2**31 - 1))
    return outcome, resolver, _route_class(values)


def as_demanded(problem: Problem, values: Any) -> Problem:
    """Return the problem with the clearances that a result says were demanded; earlier versions say nothing."""
    own = values if isinstance(values, dict) else {}
    robot = demanding(problem.robot, own.get("demanded_clearance"), own.get("demanded_self_clearance"))
    return problem if robot is problem.robot else problem.changed(robot=robot)


class Entries:
    """The values of a result, checked as they are asked for.

    Raises
    ------
    InputError
        When they are no mapping, a key is missing, or its value cannot be meant.
    """

    def __init__(self, values: Any) -> None:
        checks.instance("", values, dict, "a result")
        self._values = values

    def value(self, key: str) -> Any:
        """Return what stands under a key."""
        if key not in self._values:
            raise InputError(key, "missing", self._values, "a result of an earlier solve")
        return self._values[key]

    def number(self, key: str, low: float = -math.inf) -> float:
        """Return a number of at least `low`."""
        return checks.number(key, self.value(key), low=low)

    def optional(self, key: str) -> float | None:
        """Return a number, or nothing."""
        return None if self.value(key) is None else self.number(key)

    def integer(self, key: str, high: int) -> int:
        """Return a whole number from 0 to `high`."""
        return checks.integer(key, self.value(key), 0, high)

    def text(self, key: str) -> str:
        """Return a text."""
        return checks.text(key, self.value(key))

    def choice(self, key: str, among: tuple[str, ...]) -> str:
        """Return one of some words."""
        return str(checks.choice(key, self.value(key), among))

    def items(self, key: str) -> list[Any]:
        """Return a list."""
        checks.instance(key, self.value(key), list, "a list")
        return self._values[key]


def _or(value: float | None, otherwise: float) -> float:
    return otherwise if value is None else value


def _route_class(values: dict[str, Any]) -> RouteClass | None:
    """The class of routes; results of earlier versions have none."""
    own = values.get("route_class")
    if own is None:
        return None
    with checks.inside("route_class"):
        return RouteClass.from_dict(own)


def _cell(result: Entries) -> float:
    """Edge of the cells by which it was proved that there is no route."""
    with checks.inside("reason"):
        return Entries(result.value("reason")).number("available")
