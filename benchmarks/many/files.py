"""Batches from file to file: how many rows a second end to end, and how much memory."""

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.many.child import run
from benchmarks.many.questions import table

SECTION = "batches from NPZ to NPZ, 5 segments, 2 threads, end to end; at most 16 starts, among spheres 6"

KINDS = {
    "free poses (position and direction)": (10_000_000, True, False, 350_000.0),
    "free points (position alone)": (10_000_000, False, False, 500_000.0),
    "poses among 40 spheres, proved": (500_000, True, True, 80_000.0),
    "points among 40 spheres, proved": (500_000, False, True, 80_000.0),
}
"""How many rows, whether directions are asked, whether there are obstacles, and the goal in rows a second."""


def measure(plan: Plan) -> Iterator[Line]:
    """Rate and memory of each kind."""
    for kind, (full, directions, obstacles, goal) in KINDS.items():
        with TemporaryDirectory() as folder:
            count = plan.count(full, 2_000)
            targets = table(Path(folder) / "in.npz", count, plan.rng(32), directions)
            settings = {"targets": str(targets), "out": f"{folder}/out.npz", "seed": plan.seed if obstacles else None}
            options = {"chunk": 50_000, "workers": 2, "routes": False, "max_starts": 6 if obstacles else 16}
            ran = run(**settings, options=options)
        solved = ran.counts.get("solved", 0), count
        note = f"{count:,} rows"
        rate = Goal(goal, at_most=False)
        yield Line(SECTION, kind, count / ran.seconds, "/s", rate, None, solved, note)
        yield Line(SECTION, f"{kind}, memory", ran.megabytes, "MB", Goal(500.0), None, None, note)
