"""Whether memory grows over many solves; `many` measures what a second thread adds."""

import os
import tracemalloc
from collections.abc import Iterator
from itertools import cycle, islice
from pathlib import Path

from benchmarks.harness import Goal, Line, Plan
from benchmarks.problems import ProblemSet, among_spheres, arm
from sinuous.solver.solver import Solver

SECTION = "endurance"


def measure(plan: Plan) -> Iterator[Line]:
    """Solve again and again among spheres."""
    yield from _memory(plan, among_spheres(arm(5, 2.4, radius=4.0), 40, plan.count(500, 20), plan.rng(6)))


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
