"""Whether memory grows over many solves, and how much more two threads get done than one."""

import os
import tracemalloc
from collections.abc import Callable, Iterator
from itertools import cycle, islice
from pathlib import Path
from statistics import median
from threading import Barrier, Thread
from time import perf_counter

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.problems import ProblemSet, among_spheres, arm, full_poses
from sinuous.solving.solver import Solver

SECTION = "endurance"
ROUNDS = 5


def measure(plan: Plan) -> Iterator[Line]:
    """Memory first, then threads."""
    spheres = among_spheres(arm(5, 2.4, radius=4.0), 40, plan.count(500, 20), plan.rng(6))
    yield from _memory(plan, spheres)
    long = among_spheres(arm(20, 1.2, radius=4.0), 40, plan.count(200, 5), plan.rng(7))
    poses = full_poses(0, plan.count(1000, 20))
    for what, problems in (
        ("5 segments, 40 spheres", spheres),
        ("20 segments, 40 spheres", long),
        ("3 inextensible segments, full poses", poses),
    ):
        yield _scaling(plan, f"{what}, solve_many", problems, _at_once, Goal(1.7, at_most=False))
        yield _scaling(plan, f"{what}, a loop of solve", problems, _one_by_one, None)


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


def _at_once(solver: Solver, problems: ProblemSet, count: int) -> None:
    for _ in range(count // len(problems.targets)):
        solver.solve_many(problems.targets)


Work = Callable[[Solver, ProblemSet, int], None]


def _scaling(plan: Plan, what: str, problems: ProblemSet, work: Work, goal: Goal | None) -> Line:
    """Work done by two threads with a solver each, over that of one in the same time; median of several rounds."""
    solvers = [Solver(problems.robot, problems.scene, tolerance=problems.tolerance) for _ in range(2)]
    count = plan.count(10 * len(problems.targets), len(problems.targets))
    for solver in solvers:
        work(solver, problems, count)
    ratios = [
        2.0 * _together(solvers[:1], problems, count, work) / _together(solvers, problems, count, work)
        for _ in range(plan.count(ROUNDS, 1))
    ]
    note = f"{count} solves a thread, median of {len(ratios)} rounds: " + ", ".join(f"{ratio:.2f}" for ratio in ratios)
    return Line(SECTION, f"two threads over one, {what}", median(ratios), "x", goal, note=note, noise=0.5)


def _together(solvers: list[Solver], problems: ProblemSet, count: int, work: Work) -> float:
    """Seconds until all threads are through, each with `count` solves on its own solver."""
    barrier = Barrier(len(solvers) + 1)

    def run(solver: Solver) -> None:
        barrier.wait()
        work(solver, problems, count)

    threads = [Thread(target=run, args=(solver,)) for solver in solvers]
    for thread in threads:
        thread.start()
    barrier.wait()
    began = perf_counter()
    for thread in threads:
        thread.join()
    return perf_counter() - began
