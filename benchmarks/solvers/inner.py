"""Times inside the kernels, without Python around them: compiled loops that do the same many times."""

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.judges.judge import Flags
from benchmarks.problems import ProblemSet
from sinuous.base.checks import Floats
from sinuous.kernels.body.self_pairs import Shape
from sinuous.kernels.body.self_proof import prove_self
from sinuous.kernels.chain.kinematics import forward
from sinuous.kernels.clock import LONGEST, allow, begin
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.problem import read_problem
from sinuous.kernels.solve.search import search
from sinuous.kernels.tables import SOLVED
from sinuous.methods.search import FINEST, carve_check, check_size
from sinuous.solver.solver import Solver


@entry
def repeat(times: int, *arguments: Any) -> tuple[int, int]:
    """Search `times` times over; return status and iterations of the last time."""
    status = used = 0
    for _ in range(times):
        answer = search(*arguments)
        status, used = answer[0], answer[1]
    return status, used


@entry
def repeat_self_proof(
    times: int, robot: Array, scene: Array, settings: Array, targets: Array, q: Array, scratch: Array
) -> float:
    """Prove `times` times that the body does not run through itself at `q` (n, 3); return the sum of what is proved.

    The groups are those of a solve; `scratch`: see `search.check_size`.
    """
    problem = read_problem(robot, scene, settings, targets)
    check, _ = carve_check(scratch, problem)
    begin(check.clock)
    allow(check.clock, LONGEST)
    forward(q, check.frames)
    total = 0.0
    for _ in range(times):
        shape = Shape(problem.limits, q, check.frames, check.spans)
        _, least, _ = prove_self(shape, FINEST * problem.unit, check.clock)
        total += least
    return total


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
        arguments = solver._first_call(target).arguments
        began = perf_counter()
        status, used = repeat(times, *arguments)
        rows.append(((perf_counter() - began) / times, used, status == SOLVED, solver.solve(target).q))
    seconds, iterations, solved, answers = zip(*rows[1:], strict=True)
    return InnerTimes(np.array(seconds), np.array(iterations, float), np.array(solved), np.array(answers))


def self_proof_times(problems: ProblemSet, q: Floats, times: int) -> Floats:
    """Seconds (m,) that one proof takes that the body does not run through itself at `q` (m, n, 3)."""
    solver = Solver(problems.robot, problems.scene, tolerance=problems.tolerance)
    robot, _, settings, targets, *_ = solver._first_call(problems.targets[0]).arguments
    scene = solver.scene.snapshot().group.copy()
    scratch = np.empty(check_size(len(problems.robot), len(problems.scene)))
    seconds = []
    for each in [q[0], *q]:  # the first once more: it loads or compiles
        began = perf_counter()
        repeat_self_proof(times, robot, scene, settings, targets, each, scratch)
        seconds.append((perf_counter() - began) / times)
    return np.array(seconds[1:])
