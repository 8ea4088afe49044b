"""A batch that is killed half-way goes on, and is the same in the end; tests do it in all other ways."""

import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.many.child import begin, run
from benchmarks.many.questions import table

SECTION = "killed with -9 half-way, and begun again"
NONE = Goal(0.0, correctness=True)


def measure(plan: Plan) -> Iterator[Line]:
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
    yield Line(SECTION, "chunks done when it was killed", float(len(before)), "", note="of 60")
    yield Line(SECTION, "chunks done twice", float(again), "", NONE)
    yield Line(SECTION, "chunks lost", float(60 - len(after)), "", NONE)
    yield Line(SECTION, "results that differ from an undisturbed run", float(not same), "", NONE)


def _chunks(out: Path) -> dict[str, int]:
    """Chunks that are there, and when they were written."""
    found = out.with_name(out.name + ".parts").glob("chunk-*.npz")
    return {file.name: file.stat().st_mtime_ns for file in found}
