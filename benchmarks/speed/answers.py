"""Solve many problems one by one, take the times, and have every answer judged."""

from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.judges.judge import Flags
from benchmarks.problems import ProblemSet
from sinuous.base.checks import Floats
from sinuous.solver.solver import Solver


@dataclass(frozen=True)
class Answers:
    """What came of m problems.

    Attributes
    ----------
    q : ndarray (m, n, 3)
    seconds : ndarray (m,)
        Around the call, solved or not.
    claimed, confirmed : ndarray (m,) of bool
        Whether the solver says solved, and whether the judge agrees with that.
    """

    q: Floats
    seconds: Floats
    claimed: Flags
    confirmed: Flags

    @property
    def times(self) -> Times:
        """Summary of the times of all problems."""
        return Times.of(self.seconds)

    @property
    def solved(self) -> tuple[int, int]:
        """How many were confirmed, of how many."""
        return int(self.confirmed.sum()), len(self.confirmed)

    @property
    def percent(self) -> float:
        """Share of confirmed ones."""
        return 100.0 * float(self.confirmed.mean())

    @property
    def complaint(self) -> str:
        """Numbers of problems that are not confirmed, to begin a search with."""
        failed = np.flatnonzero(~self.confirmed)
        lies = np.flatnonzero(self.claimed & ~self.confirmed)
        parts = [f"not solved: {_some(failed)}"] if len(failed) else []
        parts += [f"FALSE: {_some(lies)}"] if len(lies) else []
        return "; ".join(parts)


def _some(numbers: NDArray[np.intp]) -> str:
    return ", ".join(str(i) for i in numbers[:5]) + (" ..." if len(numbers) > 5 else "")


def solve_all(plan: Plan, problems: ProblemSet, what: str) -> Answers:
    """Solve every problem from cold, through `Solver.solve`, with the defaults of a user."""
    solver = Solver(problems.robot, problems.scene, tolerance=problems.tolerance)
    solver.solve(problems.targets[0])
    q, seconds, claimed = [], [], []
    for target in plan.track(problems.targets, what, len(problems.targets)):
        began = perf_counter()
        solution = solver.solve(target)
        seconds.append(perf_counter() - began)
        q.append(solution.q)
        claimed.append(solution.solved)
    said, found = np.array(claimed), np.array(q)
    return Answers(found, np.array(seconds), said, said & problems.right(found))
