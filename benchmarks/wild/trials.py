"""One wild world solved problem by problem, every claim held against judges and against what is known to be possible."""

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import ROUNDING, target_errors, within_limits
from benchmarks.judges.self_collision import look
from benchmarks.wild.worlds import World
from sinuous.checks import Floats
from sinuous.solution.solution import Solution
from sinuous.solution.status import Status
from sinuous.solving.solver import Solver

LIMIT = 1.0
"""Budget of one solve, in seconds."""

IMPOSSIBLE = (Status.OUT_OF_REACH, Status.TARGET_BLOCKED, Status.BASE_BLOCKED, Status.NO_ROUTE)
"""What no problem may be called: it has a hidden solution."""

TARGET, LIMITS, OVERLAP, SELF_OVERLAP = "target missed", "limits", "overlap", "overlap with itself"
CLEARANCE, SELF_CLEARANCE = "clearance overstated", "self-clearance overstated"

FALSE = (TARGET, LIMITS, OVERLAP, SELF_OVERLAP, CLEARANCE, SELF_CLEARANCE, *map(str, IMPOSSIBLE))
"""Kinds of false claims: of what is called solved, then words for what is not."""

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


def solutions_of(world: World) -> tuple[list[Solution], list[float]]:
    """Solve all problems, one by one, with the defaults of a user; how long each took, in seconds."""
    solver = Solver(world.robot, world.scene, tolerance=world.tolerance, time=LIMIT)
    solutions, seconds = [], []
    for targets in world.targets:
        began = perf_counter()
        solutions.append(solver.solve(targets))
        seconds.append(perf_counter() - began)
    return solutions, seconds


def examine(world: World) -> list[Trial]:
    """Solve all problems of a world, and judge all claims."""
    solutions, seconds = solutions_of(world)
    false: list[tuple[str, ...]] = [
        (str(solution.status),) if solution.status in IMPOSSIBLE else () for solution in solutions
    ]
    claims = [i for i, solution in enumerate(solutions) if solution.solved]
    if claims:
        for i, kinds in zip(claims, _refuted(world, claims, [solutions[i] for i in claims]), strict=True):
            false[i] = kinds
    statuses = [str(solution.status) for solution in solutions]
    return [Trial(*each) for each in zip(statuses, seconds, false, strict=True)]


def _refuted(world: World, claims: list[int], solutions: list[Solution]) -> list[tuple[str, ...]]:
    """What is false of solutions that are called solved, those of problems `claims`."""
    robot, q = world.robot, np.array([solution.q for solution in solutions])
    slack = GRACE * robot.mean_length
    found = {TARGET: ~_at_targets(world, claims, q), LIMITS: ~within_limits(robot, q)}
    if len(world.scene):
        said = np.array([solution.clearance for solution in solutions], np.float64)
        gaps = Clearances(robot, world.scene).least(q, float(np.nanmax(said)))
        found[OVERLAP] = gaps < -slack
        found[CLEARANCE] = said > gaps + slack
    said = np.array([getattr(solution, "self_clearance", None) for solution in solutions], np.float64)
    gaps = look(robot, q, 0.0).least
    found[SELF_OVERLAP] = gaps < -slack
    found[SELF_CLEARANCE] = said > gaps + slack  # nothing said is NaN, and no claim
    return [tuple(kind for kind in FALSE if kind in found and found[kind][i]) for i in range(len(q))]


def _at_targets(world: World, claims: list[int], q: Floats) -> np.ndarray:
    """Whether configurations meet all targets of problems `claims`."""
    tolerance = world.tolerance
    good = np.ones(len(q), bool)
    for targets in zip(*(world.targets[i] for i in claims), strict=True):
        position, angle = target_errors(world.robot, targets, q)
        good &= position <= (tolerance.position or 0.0) + ROUNDING * world.robot.mean_length
        good &= angle <= tolerance.angle + ROUNDING
    return good
