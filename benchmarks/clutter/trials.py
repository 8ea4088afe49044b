"""One place, solved by several solvers, each answer judged: what `clutter` repeats many times."""

from dataclasses import dataclass
from functools import lru_cache
from time import perf_counter
from typing import Any, NamedTuple

from benchmarks.places import FAMILIES, Place, make
from benchmarks.places.place import right as judged_right
from benchmarks.solvers.among_spheres import AmongSpheres
from sinuous.answer.solution import Solution
from sinuous.answer.status import Status
from sinuous.model.robot import Robot
from sinuous.problem.target import Tolerance
from sinuous.scene.scene import Scene
from sinuous.solver.solver import Solver

ARC, RANDOM, IPOPT = "arc", "random", "ipopt"
"""Solvers to compare with: the single arc alone, it and `RANDOM_STARTS` random starts, IPOPT."""

RANDOM_STARTS = 100

IMPOSSIBLE = (Status.OUT_OF_REACH, Status.TARGET_BLOCKED, Status.BASE_BLOCKED, Status.NO_ROUTE)
"""What no place may be called: there is the hidden shape."""


@dataclass(frozen=True)
class Attempt:
    """What one solver came to.

    Attributes
    ----------
    first, seconds : float
        Of the first solve, which makes what a solver puts off, and of the second, which is what counts.
    status : str
    start : str
        Kind of the start that won.
    claimed, right : bool
        Whether it says solved, and whether the judge finds it so, who looks at nothing else.
    """

    first: float
    seconds: float
    status: str
    start: str
    claimed: bool
    right: bool

    @property
    def solved(self) -> bool:
        """Whether it says so and is."""
        return self.claimed and self.right

    @property
    def false(self) -> bool:
        """Whether the judge refutes that it is solved, or the hidden shape that it is impossible."""
        return (self.claimed and not self.right) or self.status in IMPOSSIBLE


@dataclass(frozen=True)
class Trial:
    """One place, and what came of it.

    Attributes
    ----------
    family : str
    seed : int
    prepare : float
        Seconds to make scene and solver.
    ours : Attempt
    proof : float or None
        Of the seconds inside the kernel, the share that one look and the proof take: those of solving again from the
        answer. None where it is not solved.
    others : dict of str to Attempt
        By `ARC`, `RANDOM`, `IPOPT`: what was asked for and is possible.
    """

    family: str
    seed: int
    prepare: float
    ours: Attempt
    proof: float | None
    others: dict[str, Attempt]

    @classmethod
    def of(cls, plain: dict[str, Any]) -> "Trial":
        """Return the trial whose attributes a journal holds."""
        others = {name: Attempt(**attempt) for name, attempt in plain["others"].items()}
        return cls(**{**plain, "ours": Attempt(**plain["ours"]), "others": others})


class Task(NamedTuple):
    """What to examine: a place, the solvers to compare with, and attempts of ours that are switched off."""

    family: str
    seed: int
    compared: tuple[str, ...] = ()
    without: tuple[str, ...] = ()


def examine(task: Task) -> Trial:
    """Make a place and solve it, by ours and by what it is compared with."""
    family, seed, compared, without = task
    place = make(family, seed)
    prepared = _shared if FAMILIES[family].published else _prepared
    solver, prepare = prepared(place.robot, place.scene, place.tolerance, without)
    ours, solution = _attempt(place, solver)
    others = {}
    for name, most in ((ARC, 1), (RANDOM, 1 + RANDOM_STARTS)):
        if name in compared:
            others[name], _ = _attempt(place, _local(place.robot, solver.scene, place.tolerance, most))
    if IPOPT in compared and AmongSpheres.takes(place.robot, place.scene):
        others[IPOPT] = _interior(place)
    return Trial(family, seed, prepare, ours, _proof(solver, place, solution), others)


def _prepared(robot: Robot, scene: Scene, tolerance: Tolerance, without: tuple[str, ...]) -> tuple[Solver, float]:
    """Return the solver that a user gets, and the seconds that it took to make."""
    began = perf_counter()
    solver = Solver(robot, Scene(scene.obstacles), tolerance=tolerance, without=without)
    return solver, perf_counter() - began


_shared = lru_cache(maxsize=16)(_prepared)
"""For places that share robot and scene, which are the published ones."""


@lru_cache(maxsize=2)
def _local(robot: Robot, scene: Scene, tolerance: Tolerance, most: int) -> Solver:
    """Return a solver without routes, which follows so many starts at most."""
    return Solver(robot, scene, tolerance=tolerance, max_starts=most, routes=False)


def _attempt(place: Place, solver: Solver) -> tuple[Attempt, Solution]:
    spent = []
    for _ in range(2):
        began = perf_counter()
        solution = solver.solve(place.targets)
        spent.append(perf_counter() - began)
    right = solution.solved and judged_right(place, solution.q)
    return Attempt(spent[0], spent[1], str(solution.status), solution.start, solution.solved, right), solution


def _proof(solver: Solver, place: Place, solution: Solution) -> float | None:
    """See `Trial.proof`; the least of three, because one look takes only some microseconds."""
    if not solution.solved:
        return None
    again = [solver.solve(place.targets, initial=solution) for _ in range(3)]
    return min(each._outcome.seconds for each in again) / solution._outcome.seconds


@lru_cache(maxsize=4)
def _program(robot: Robot, scene: Scene, tolerance: Tolerance) -> AmongSpheres:
    return AmongSpheres(robot, scene, tolerance)


def _interior(place: Place) -> Attempt:
    """Try IPOPT from one start after the other until the judge is content; it need not say so itself."""
    program = _program(place.robot, place.scene, place.tolerance)
    spent = 0.0
    for start in range(AmongSpheres.STARTS):
        q, seconds = program.solve(place.target, start)
        spent += seconds
        if judged_right(place, q):
            return Attempt(spent, spent, "solved", "arc" if start == 0 else "random", True, True)
    return Attempt(spent, spent, "failed", "", False, False)
