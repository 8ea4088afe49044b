"""Batches from file to file: rows a second end to end, memory, and one that is killed half-way and goes on."""

import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.many.child import begin, run
from benchmarks.many.questions import table

SECTION = "batches from NPZ to NPZ, 5 segments, 2 threads, end to end; at most 16 starts, among spheres 6"

KILLED = "killed with -9 half-way, and begun again"
NONE = Goal(0.0, correctness=True)

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


def deaths(plan: Plan) -> Iterator[Line]:
    """Count chunks that were lost or done twice, and differences in the end."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        count = plan.count(500_000, 60_000)
        options = {"chunk": -(-count // 60), "time": 60.0, "max_starts": 20}  # nothing may depend on time
        targets = str(table(folder / "in.npz", count, plan.rng(35), directions=True))
        run(targets=targets, out=str(folder / "whole.npz"), options=options)
        out = folder / "out.npz"
        process = begin(targets=targets, out=str(out), options=options)
        while len(_chunks(out)) < 30 and process.poll() is None:
            time.sleep(0.002)
        process.kill()
        process.communicate()
        before = _chunks(out)
        run(targets=targets, out=str(out), options={**options, "shard": (1, 1)})
        after = _chunks(out)
        again = sum(after.get(chunk) != written for chunk, written in before.items())
        run(targets=targets, out=str(out), options=options)
        same = out.read_bytes() == (folder / "whole.npz").read_bytes()
    yield Line(KILLED, "chunks done when it was killed", float(len(before)), "", note="of 60")
    yield Line(KILLED, "chunks done twice", float(again), "", NONE)
    yield Line(KILLED, "chunks lost", float(60 - len(after)), "", NONE)
    yield Line(KILLED, "results that differ from an undisturbed run", float(not same), "", NONE)


def _chunks(out: Path) -> dict[str, int]:
    """Chunks that are there, and when they were written."""
    found = out.with_name(out.name + ".parts").glob("chunk-*.npz")
    return {file.name: file.stat().st_mtime_ns for file in found}
