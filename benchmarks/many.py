"""`python -m benchmarks many`: batches through files, on one worker and on several.

What is timed with its memory runs in a process of its own. That a batch which is killed loses nothing is tested in
`tests/studies/batch/test_deaths.py`.
"""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

import sinuous as sn
from benchmarks.harness import Goal, Line, Part, Plan, ignore_suspicions, timed
from benchmarks.problems import among_spheres, arm, random_configurations
from sinuous.base.checks import Floats
from sinuous.base.system import pool_of
from sinuous.studies.batch.solve import solve_batch
from sinuous.studies.runs.engines import NO_PAGE, distributed

ROBOT = arm(5, 2.4, radius=4)
SPHERES = 40
TOGETHER = 100_000

FILES = "batches from NPZ to NPZ, 5 segments, 2 threads, end to end; at most 16 starts, among spheres 6"

KINDS = {
    "free poses (position and direction)": (10_000_000, True, False, 350_000.0),
    "free points (position alone)": (10_000_000, False, False, 500_000.0),
    "poses among 40 spheres, proved": (500_000, True, True, 80_000.0),
    "points among 40 spheres, proved": (500_000, False, True, 80_000.0),
}
"""How many rows, whether directions are asked, whether there are obstacles, and the goal in rows a second."""

ENGINES = "engines, free poses and 40 spheres, chunks of 10,000, the better of three runs in turn"

TURNS = 3


def spheres(plan: Plan) -> sn.Scene:
    """The obstacles that the robot works among."""
    return among_spheres(ROBOT, SPHERES, 1, plan.rng(30)).scene


def tips(robot: sn.Robot, count: int, rng: np.random.Generator) -> Floats:
    """Poses (count, 4, 4) of the tips of random shapes."""
    return np.asarray(robot.tip(random_configurations(robot, count, rng)))


def table(file: Path, count: int, rng: np.random.Generator, directions: bool) -> Path:
    """Write an NPZ file of positions, and perhaps directions, that random shapes have."""
    arrays: dict[str, Any] = {"positions": np.empty((count, 3))}
    if directions:
        arrays["directions"] = np.empty((count, 3))
    for first in range(0, count, TOGETHER):
        some = tips(ROBOT, min(TOGETHER, count - first), rng)
        arrays["positions"][first : first + len(some)] = some[:, :3, 3]
        if directions:
            arrays["directions"][first : first + len(some)] = some[:, :3, 2]
    np.savez(file, **arrays)
    return file


class Ran(NamedTuple):
    """What a batch took: seconds end to end, without compiling; megabytes at most; rows by status."""

    seconds: float
    megabytes: float
    counts: dict[str, int]


def run(targets: Path, out: Path, seed: int | None, options: dict[str, Any]) -> Ran:
    """Run a batch, among the spheres of a seed or without any."""
    scene, few = None if seed is None else spheres(Plan(seed)), tips(ROBOT, 300, Plan(seed or 0).rng(31))
    solve_batch(ROBOT, {"positions": few[:, :3, 3], "directions": few[:, :3, 2]}, scene, time=0.05)  # compiled now
    found, seconds = timed(solve_batch, ROBOT, targets, scene, out, **options)
    return Ran(seconds, _megabytes(), dict(found.counts))


def _megabytes() -> float:
    """Most memory of this process; what `getrusage` says begins with that of the parent."""
    told = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(told.split("VmHWM:")[1].split()[0]) / 1024.0


def through_files(plan: Plan) -> Iterator[Line]:
    """Rate and memory of each kind."""
    for kind, (full, directions, obstacles, goal) in KINDS.items():
        with TemporaryDirectory() as folder:
            count = plan.count(full, 2_000)
            targets = table(Path(folder) / "in.npz", count, plan.rng(32), directions)
            options = {"chunk": 50_000, "workers": 2, "routes": False, "max_starts": 6 if obstacles else 16}
            with pool_of(1, ignore_suspicions) as alone:  # its memory is that of the batch
                seed = plan.seed if obstacles else None
                ran = alone.submit(run, targets, Path(folder) / "out.npz", seed, options).result()
        solved = ran.counts.get("solved", 0), count
        note = f"{count:,} rows"
        rate = Goal(goal, at_most=False)
        yield Line(FILES, kind, count / ran.seconds, "/s", rate, None, solved, note)
        yield Line(FILES, f"{kind}, memory", ran.megabytes, "MB", Goal(500.0), None, None, note)


def engines(plan: Plan) -> Iterator[Line]:
    """Ratios of rates inside of one run: the machine is shared."""
    count = plan.count(400_000, 2_000)
    with TemporaryDirectory() as folder:
        targets = table(Path(folder) / "in.npz", count, plan.rng(33), directions=True)
        for what, scene in (("free poses", None), ("among 40 spheres", spheres(plan))):
            some = count if scene is None else count // 4
            if scene is not None:
                targets = table(Path(folder) / "among.npz", some, plan.rng(34), directions=False)
            best = _best(partial(solve_batch, ROBOT, targets, scene, max_starts=6, routes=False))
            yield Line(ENGINES, f"{what}, one thread", some / best["one"], "/s")
            two = Goal(1.9, at_most=False)
            yield Line(ENGINES, f"{what}, two threads over one", best["one"] / best["two"], "x", two)
            dask = Goal(0.85, at_most=False)
            yield Line(ENGINES, f"{what}, Dask over threads, two workers", best["two"] / best["dask"], "x", dask)


def _best(solve: Callable[..., Any]) -> dict[str, float]:
    """Least seconds of each engine, which take turns; workers of Dask are there before."""
    module = distributed()
    best: dict[str, float] = {}
    with (
        module.LocalCluster(n_workers=2, threads_per_worker=1, silence_logs=50, **NO_PAGE) as cluster,
        module.Client(cluster) as client,
    ):
        solve(engine=client)  # what is loaded once a worker
        ways: dict[str, dict[str, Any]] = {"one": {"workers": 1}, "two": {"workers": 2}, "dask": {"engine": client}}
        for _ in range(TURNS):
            for name, own in ways.items():
                best[name] = min(best.get(name, 1e9), timed(solve, **own)[1])
    return best


PARTS: dict[str, Part] = {"files": through_files, "workers": engines}
"""What is measured, in order."""
