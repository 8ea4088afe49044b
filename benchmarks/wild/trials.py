"""One wild world solved problem by problem: every claim is held against judges, and against the hidden solutions."""

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from benchmarks.judges.bodies import measured_body, needed_body, self_body
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import ROUNDING, Flags, target_errors, within_limits
from benchmarks.judges.self_collision import look
from benchmarks.wild.worlds import World
from sinuous.answer.solution import Solution
from sinuous.answer.status import Status
from sinuous.base.checks import Floats
from sinuous.solver.solver import Solver

IMPOSSIBLE = (Status.OUT_OF_REACH, Status.TARGET_BLOCKED, Status.BASE_BLOCKED, Status.NO_ROUTE)
"""What no problem may be called: it has a hidden solution."""

TARGET, LIMITS, OVERLAP, SELF_OVERLAP = "target missed", "limits", "overlap", "overlap with itself"
DEMAND = "less clearance than is demanded"
CLEARANCE, SELF_CLEARANCE = "clearance overstated", "self-clearance overstated"

EXCEPTION = "exception"

FALSE = (TARGET, LIMITS, OVERLAP, SELF_OVERLAP, DEMAND, CLEARANCE, SELF_CLEARANCE, *map(str, IMPOSSIBLE), EXCEPTION)
"""Kinds of false claims: of what is called solved, then words for what is not; and a call that ended in no answer."""

GRACE = 1e-9
"""By how much of its length a body may overlap, so that rounding accuses nobody."""


@dataclass(frozen=True)
class Trial:
    """What came of one problem.

    Attributes
    ----------
    status : str
    seconds : float
        Around the call.
    false : tuple of str
        Which of `FALSE` the judges found.
    """

    status: str
    seconds: float
    false: tuple[str, ...] = ()

    @property
    def solved(self) -> bool:
        """Whether it says so, and nothing of it is false."""
        return self.status == Status.SOLVED and not self.false


def solutions_of(world: World) -> tuple[list[Solution | Exception], list[float]]:
    """Solve all problems, one by one, with the defaults of a user; how long each took, in seconds."""
    solver = Solver(world.robot, world.scene, tolerance=world.tolerance, time=world.time)
    solutions: list[Solution | Exception] = []
    seconds = []
    for targets in world.targets:
        began = perf_counter()
        try:
            solutions.append(solver.solve(targets))
        except Exception as error:  # whatever it is, it is counted
            solutions.append(error)
        seconds.append(perf_counter() - began)
    return solutions, seconds


def examine(world: World) -> list[Trial]:
    """Solve all problems of a world, and judge all claims."""
    found, seconds = solutions_of(world)
    false = refuted(world, {i: each for i, each in enumerate(found) if isinstance(each, Solution)})
    return [
        Trial(str(each.status), seconds[i], false[i])
        if isinstance(each, Solution)
        else Trial(EXCEPTION, seconds[i], (EXCEPTION,))
        for i, each in enumerate(found)
    ]


def refuted(world: World, solutions: dict[int, Solution]) -> dict[int, tuple[str, ...]]:
    """What is false of solutions of some problems, by their numbers."""
    false: dict[int, tuple[str, ...]] = {
        i: (str(each.status),) if world.possible and each.status in IMPOSSIBLE else () for i, each in solutions.items()
    }
    claims = {i: each for i, each in solutions.items() if each.solved}
    if claims:
        wrong = _wrong(world, claims)
        false |= {i: tuple(kind for kind in FALSE if kind in wrong and wrong[kind][at]) for at, i in enumerate(claims)}
    return false


def _wrong(world: World, claims: dict[int, Solution]) -> dict[str, Flags]:
    """Where solutions that are called solved are wrong, kind by kind."""
    robot, q = world.robot, np.array([solution.q for solution in claims.values()])
    slack = GRACE * robot.mean_length
    found = {
        TARGET: ~_at_targets(world, list(claims), q),
        LIMITS: ~within_limits(robot, q),
        DEMAND: np.zeros(len(q), bool),
    }
    if len(world.scene):
        scene, said = world.truth or world.scene, _said(claims, "clearance")
        gaps = Clearances(measured_body(robot), scene).least(q, max(0.0, float(np.nanmax(said))))
        found |= {OVERLAP: gaps < -slack, CLEARANCE: said > gaps + slack}
        if np.any(robot.clearance):
            found[DEMAND] |= Clearances(needed_body(robot), scene).least(q, 0.0) < -slack
    gaps, thick = look(robot, q, 0.0).least, self_body(robot)
    left = gaps if thick is robot else look(thick, q, 0.0).least
    least = float(np.min(robot.self_clearance))
    found[DEMAND] |= left < -slack
    return found | {SELF_OVERLAP: gaps < -slack, SELF_CLEARANCE: _said(claims, "self_clearance") > left + least + slack}


def _said(claims: dict[int, Solution], name: str) -> Floats:
    """A bound that every solution claims; NaN where it claims none."""
    values = [getattr(solution, name, None) for solution in claims.values()]
    return np.array([np.nan if value is None else value for value in values], np.float64)


def _at_targets(world: World, problems: list[int], q: Floats) -> Flags:
    """Whether configurations meet all targets of these problems."""
    tolerance = world.tolerance
    good = np.ones(len(q), bool)
    for targets in zip(*(world.targets[i] for i in problems), strict=True):
        position, angle = target_errors(world.robot, targets, q)
        good &= position <= (tolerance.position or 0.0) + ROUNDING * world.robot.mean_length
        good &= angle <= tolerance.angle + ROUNDING
    return good
