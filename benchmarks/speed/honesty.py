"""No false "solved": random robots among all kinds of obstacles, targets possible and not, claims judged."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.parallel import in_processes
from benchmarks.harness.plan import Plan
from benchmarks.judges.judge import within_limits
from benchmarks.problems import clutter
from sinuous.solver.solver import Solver

SECTION = 'no false "solved": random robots (3 to 6 segments) among all kinds of obstacles, default tolerance'
TARGETS = 100
"""Targets in one scene."""

STARTS = 3
"""Starts of one solve: many answers, quickly, matter more here than that all are found."""


class Tally(NamedTuple):
    """What came of one scene.

    Attributes
    ----------
    claimed : int
    false : list of int
        Numbers of the targets whose claim the judge rejects.
    outside : list of int
        Numbers of the targets whose answer, solved or not, is outside the limits.
    """

    claimed: int
    false: list[int]
    outside: list[int]


def examine(seed: int) -> Tally:
    """Solve and judge one scene; `clutter(seed, TARGETS)` makes it again."""
    problems = clutter(seed, TARGETS)
    solver = Solver(problems.robot, problems.scene, tolerance=problems.tolerance, max_starts=STARTS)
    solutions = [solver.solve(target) for target in problems.targets]
    claims = np.flatnonzero([solution.solved for solution in solutions])
    q = np.array([solution.q for solution in solutions])
    lies = claims[~problems.only(claims).right(q[claims])] if len(claims) else claims
    outside = np.flatnonzero(~within_limits(problems.robot, q))
    return Tally(len(claims), lies.tolist(), outside.tolist())


def measure(plan: Plan) -> Iterator[Line]:
    """Count false claims, and answers outside the limits."""
    seeds = range(1000 * plan.seed, 1000 * plan.seed + plan.count(1000, 5))
    found = list(plan.track(in_processes(examine, seeds, alone=plan.quick, chunk=5), "false claims", len(seeds)))
    claimed, total = sum(tally.claimed for tally in found), TARGETS * len(seeds)
    false = {seed: tally.false for seed, tally in zip(seeds, found, strict=True) if tally.false}
    outside = {seed: tally.outside for seed, tally in zip(seeds, found, strict=True) if tally.outside}
    solved = claimed - _sum(false), total
    goal = Goal(0, correctness=True)
    yield Line(SECTION, "false claims", _sum(false), "", goal, None, solved, _seeds(false))
    yield Line(SECTION, "answers outside limits, solved or not", _sum(outside), "", goal, None, None, _seeds(outside))


def _sum(numbers: dict[int, list[int]]) -> int:
    return sum(len(found) for found in numbers.values())


def _seeds(numbers: dict[int, list[int]]) -> str:
    """Scene seeds and targets of the first few, to make them again."""
    return "; ".join(f"clutter({seed}): {found[:5]}" for seed, found in list(numbers.items())[:5])
