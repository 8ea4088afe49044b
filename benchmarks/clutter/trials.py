"""One place, solved and judged: what `clutter` repeats many times."""

from dataclasses import dataclass
from functools import lru_cache
from time import perf_counter
from typing import Any, NamedTuple

import sinuous as sn
from benchmarks.places import FAMILIES, Place, make
from benchmarks.places.place import right as judged_right
from sinuous.solver.solver import Solver

IMPOSSIBLE = (sn.Status.OUT_OF_REACH, sn.Status.TARGET_BLOCKED, sn.Status.BASE_BLOCKED, sn.Status.NO_ROUTE)
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
    ours, arc : Attempt
        Of the solver that a user gets, and of one that begins at the single arc alone.
    """

    family: str
    seed: int
    prepare: float
    ours: Attempt
    arc: Attempt

    @classmethod
    def of(cls, plain: dict[str, Any]) -> "Trial":
        """Return the trial whose attributes a journal holds."""
        return cls(**{**plain, "ours": Attempt(**plain["ours"]), "arc": Attempt(**plain["arc"])})


class Task(NamedTuple):
    """What to examine: a place, and attempts of ours that are switched off."""

    family: str
    seed: int
    without: tuple[str, ...] = ()


def examine(task: Task) -> Trial:
    """Make a place and solve it."""
    family, seed, without = task
    place = make(family, seed)
    prepared = _shared if FAMILIES[family].published else _prepared
    solver, prepare = prepared(place.robot, place.scene, place.tolerance, without)
    return Trial(
        family,
        seed,
        prepare,
        _attempt(place, solver),
        _attempt(place, _local(place.robot, place.scene, place.tolerance)),
    )


def _prepared(
    robot: sn.Robot, scene: sn.Scene, tolerance: sn.Tolerance, without: tuple[str, ...]
) -> tuple[Solver, float]:
    """Return the solver that a user gets, and the seconds that it took to make."""
    began = perf_counter()
    solver = Solver(robot, sn.Scene(scene.obstacles), tolerance=tolerance, without=without)
    return solver, perf_counter() - began


_shared = lru_cache(maxsize=16)(_prepared)
"""For places that share robot and scene, which are the published ones."""


@lru_cache(maxsize=2)
def _local(robot: sn.Robot, scene: sn.Scene, tolerance: sn.Tolerance) -> Solver:
    """Return a solver without routes, which follows one start."""
    return Solver(robot, scene, tolerance=tolerance, max_starts=1, routes=False)


def _attempt(place: Place, solver: Solver) -> Attempt:
    spent = []
    for _ in range(2):
        began = perf_counter()
        solution = solver.solve(place.targets)
        spent.append(perf_counter() - began)
    right = solution.solved and judged_right(place, solution.q)
    return Attempt(spent[0], spent[1], str(solution.status), solution.start, solution.solved, right)
