"""The time of a solve inside the kernel, without Python around it: a compiled loop that calls the search many times."""

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.judges.judge import Flags
from benchmarks.problems import ProblemSet
from sinuous.checks import Floats
from sinuous.kernels.compile import entry
from sinuous.kernels.solve.search import search
from sinuous.kernels.tables import SOLVED
from sinuous.solving.solver import Solver


@entry
def repeat(times: int, *arguments: Any) -> tuple[int, int]:
    """Search `times` times over; return status and iterations of the last time."""
    status = used = 0
    for _ in range(times):
        answer = search(*arguments)
        status, used = answer[0], answer[1]
    return status, used


@dataclass(frozen=True)
class InnerTimes:
    """What m problems took inside the kernel, each alone in its loop.

    Attributes
    ----------
    seconds : ndarray (m,)
        Of one solve.
    iterations : ndarray (m,)
        Of one solve.
    solved : ndarray (m,) of bool
    q : ndarray (m, n, 3)
        The answers, to be judged.
    """

    seconds: Floats
    iterations: Floats
    solved: Flags
    q: Floats


def inner_times(problems: ProblemSet, times: int) -> InnerTimes:
    """Solve every problem `times` times in the compiled loop, with the arguments that `Solver.solve` hands over."""
    solver = Solver(problems.robot, problems.scene, tolerance=problems.tolerance)
    rows = []
    for target in [problems.targets[0], *problems.targets]:  # the first once more: it loads or compiles
        arguments = solver.build(target).arguments
        began = perf_counter()
        status, used = repeat(times, *arguments)
        rows.append(((perf_counter() - began) / times, used, status == SOLVED, solver.solve(target).q))
    seconds, iterations, solved, answers = zip(*rows[1:], strict=True)
    return InnerTimes(np.array(seconds), np.array(iterations, float), np.array(solved), np.array(answers))
