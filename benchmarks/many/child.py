"""A batch in a process of its own, so that its memory can be told, and that it can be killed.

`python -m benchmarks.many.child SETTINGS` with JSON: scene (seed of the plan, or null), targets, out, options.
"""

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[2]


class Ran(NamedTuple):
    """What a batch took: seconds end to end, without compiling; megabytes at most; rows by status."""

    seconds: float
    megabytes: float
    counts: dict[str, int]


def begin(**settings: Any) -> "subprocess.Popen[str]":
    """Begin a batch."""
    command = [sys.executable, "-m", "benchmarks.many.child", json.dumps(settings)]
    return subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)


def run(**settings: Any) -> Ran:
    """Run a batch, and wait for it."""
    out, _ = begin(**settings).communicate()
    seconds, megabytes, counts = json.loads(out.splitlines()[-1])
    return Ran(seconds, megabytes, counts)


def main(told: str) -> None:
    """Do what the parent told."""
    from benchmarks.harness.plan import Plan  # noqa: PLC0415
    from benchmarks.harness.quiet import ignore_suspicions  # noqa: PLC0415
    from benchmarks.many.questions import ROBOT, spheres, tips  # noqa: PLC0415
    from sinuous.studies.batch.solve import solve_batch  # noqa: PLC0415

    ignore_suspicions()
    settings = json.loads(told)
    plan = Plan(settings.get("seed") or 0)
    scene = None if settings.get("seed") is None else spheres(plan)
    own: dict[str, Any] = settings.get("options", {})
    few = tips(ROBOT, 300, plan.rng(31))
    solve_batch(ROBOT, {"positions": few[:, :3, 3], "directions": few[:, :3, 2]}, scene, time=0.05)  # compiled now
    began = time.perf_counter()
    found = solve_batch(ROBOT, Path(settings["targets"]), scene, settings["out"], **own)
    seconds = time.perf_counter() - began
    sys.stdout.write(json.dumps([seconds, _megabytes(), dict(found.counts)]) + "\n")


def _megabytes() -> float:
    """Most memory of this process; what `getrusage` says begins with that of the parent."""
    told = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(told.split("VmHWM:")[1].split()[0]) / 1024.0


if __name__ == "__main__":
    main(sys.argv[1])
