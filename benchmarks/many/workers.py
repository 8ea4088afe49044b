"""What another worker is worth, and what Dask costs."""

import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.many.questions import ROBOT, spheres, table
from sinuous.studies.batch.solve import solve_batch
from sinuous.studies.runs.cluster import NO_PAGE, distributed

SECTION = "engines, free poses and 40 spheres, chunks of 10,000, the better of three runs in turn"

TURNS = 3


def measure(plan: Plan) -> Iterator[Line]:
    """Ratios of rates inside of one run: the machine is shared."""
    count = plan.count(400_000, 2_000)
    with TemporaryDirectory() as folder:
        targets = table(Path(folder) / "in.npz", count, plan.rng(33), directions=True)
        for what, scene in (("free poses", None), ("among 40 spheres", spheres(plan))):
            some = count if scene is None else count // 4
            if scene is not None:
                targets = table(Path(folder) / "among.npz", some, plan.rng(34), directions=False)
            best = _best(partial(solve_batch, ROBOT, targets, scene, max_starts=6, routes=False))
            yield Line(SECTION, f"{what}, one thread", some / best["one"], "/s")
            two = Goal(1.9, at_most=False)
            yield Line(SECTION, f"{what}, two threads over one", best["one"] / best["two"], "x", two)
            dask = Goal(0.85, at_most=False)
            yield Line(SECTION, f"{what}, Dask over threads, two workers", best["two"] / best["dask"], "x", dask)


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
                began = time.perf_counter()
                solve(**own)
                best[name] = min(best.get(name, 1e9), time.perf_counter() - began)
    return best
