"""Whether memory grows over many solves, how many a second arrays bring, and what a second thread adds."""

import os
import tracemalloc
from collections.abc import Iterator
from itertools import cycle, islice
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.harness.experiment import Plan
from benchmarks.harness.lines import Goal, Line
from benchmarks.problems import ProblemSet, among_spheres, arm, full_poses, reachable
from sinuous.problem.target import GoalArrays
from sinuous.solver.solver import Solver

SECTION = "endurance"
ROUNDS = 5


def measure(plan: Plan) -> Iterator[Line]:
    """Memory first, then threads."""
    spheres = among_spheres(arm(5, 2.4, radius=4.0), 40, plan.count(500, 20), plan.rng(6))
    yield from _memory(plan, spheres)
    long = among_spheres(arm(20, 1.2, radius=4.0), 40, plan.count(200, 5), plan.rng(7))
    free = reachable(arm(5, 2.4), plan.count(1000, 20), plan.rng(8))
    for what, problems, rate in (
        ("5 segments, positions and directions", free, Goal(400_000, at_most=False)),
        ("3 inextensible segments, full poses", full_poses(0, plan.count(1000, 20)), None),
        ("5 segments, 40 spheres", spheres, None),
        ("20 segments, 40 spheres", long, None),
    ):
        yield from _arrays(plan, what, problems, rate)


def _memory(plan: Plan, problems: ProblemSet) -> Iterator[Line]:
    """Growth of what the process holds, and of what Python and NumPy allocated, after a warm-up."""
    solver = Solver(problems.robot, problems.scene)
    _one_by_one(solver, problems, 1000)
    count = plan.count(100_000, 1000)
    before = _resident()
    _one_by_one(solver, problems, count)
    grown = (_resident() - before) / 1024.0
    note = "" if before else "this system does not say what a process holds"
    yield Line(
        SECTION, f"growth of the process over {count} solves", grown, "KiB", Goal(1024.0, correctness=True), note=note
    )
    count = plan.count(20_000, 500)
    tracemalloc.start()
    try:
        _one_by_one(solver, problems, 100)
        traced = tracemalloc.get_traced_memory()[0]
        _one_by_one(solver, problems, count)
        grown = (tracemalloc.get_traced_memory()[0] - traced) / 1024.0
    finally:
        tracemalloc.stop()
    yield Line(SECTION, f"growth of traced allocations over {count} solves", grown, "KiB", Goal(64.0, correctness=True))


def _resident() -> int:
    """Bytes that the process holds in memory; 0 where the system does not say."""
    listing = Path("/proc/self/statm")
    return int(listing.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") if listing.exists() else 0


def _one_by_one(solver: Solver, problems: ProblemSet, count: int) -> None:
    for target in islice(cycle(problems.targets), count):
        solver.solve(target)


def _arrays(plan: Plan, what: str, problems: ProblemSet, rate: Goal | None) -> Iterator[Line]:
    """Poses a second through arrays with one worker and with two, and their ratio: medians of several rounds."""
    solver = Solver(problems.robot, problems.scene, tolerance=problems.tolerance)
    goals = _goals(problems, plan.count(20_000, 100))
    positions: Any = goals["positions"]
    count = len(positions)
    rounds = [[count / _seconds(solver, goals, workers) for workers in (1, 2)] for _ in range(plan.count(ROUNDS, 1))]
    note = f"{count} poses, median of {len(rounds)} rounds"
    for workers, goal in ((1, None), (2, rate)):
        reached = median(each[workers - 1] for each in rounds)
        named = f"{what}, arrays, {workers} worker{'s' if workers > 1 else ''}"
        yield Line(SECTION, named, reached, "/s", goal, note=note)
    ratios = [two / one for one, two in rounds]
    note += ": " + ", ".join(f"{ratio:.2f}" for ratio in ratios)
    goal = Goal(1.7, at_most=False)
    yield Line(SECTION, f"two threads over one, {what}, solve_many", median(ratios), "x", goal, note=note)


def _goals(problems: ProblemSet, count: int) -> GoalArrays:
    """Targets as arrays, as many as asked for, over and over again."""

    def column(name: str) -> Any:
        values = [getattr(target, name) for target in problems.targets]
        return None if values[0] is None else np.resize(np.array(values), (count, *values[0].shape))

    positions, directions, rotations = (column(name) for name in ("position", "direction", "rotation"))
    return {"positions": positions, "directions": directions, "rotations": rotations, "xyzw": None}


def _seconds(solver: Solver, goals: GoalArrays, workers: int) -> float:
    began = perf_counter()
    solver.solve_many(**goals, workers=workers)
    return perf_counter() - began
