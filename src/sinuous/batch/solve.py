"""`solve_batch`: any number of targets, through files or in memory; the same call goes on after any interruption."""

import time as clock
from collections.abc import Iterator, Mapping
from concurrent.futures import Executor
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypedDict, Unpack

from sinuous import checks
from sinuous.arguments import Rows, Truth, Whole
from sinuous.batch.answers import Answers
from sinuous.batch.batch import Batch, Failed
from sinuous.batch.checkpoint import hash_of, problem_record
from sinuous.batch.dispatch import Dispatcher, begin
from sinuous.batch.engines import LostError
from sinuous.batch.results import Results
from sinuous.batch.tables.kinds import check_results, open_source
from sinuous.batch.tables.layout import Block
from sinuous.batch.tables.source import Source
from sinuous.batch.work import Task, Work
from sinuous.errors import InputError, UnfinishedError
from sinuous.problem.target import GoalArrays
from sinuous.progress import ProgressBar
from sinuous.robot.robot import Robot
from sinuous.scene.scene import SceneLike
from sinuous.solving.many import read_workers
from sinuous.solving.memory import only_reading
from sinuous.solving.options import SolveArguments, refuse_unknown
from sinuous.solving.solver import Solver

STARTS, TIME = 100, 0.1
"""Most starts of a target, by default."""

CHUNK = 10_000
"""Rows of a chunk by default."""

MOST_CHUNK = 10_000_000
"""Most rows of a chunk."""

MOST_SHARDS = 1_000_000
"""Most shards of a batch."""

Shard = tuple[int, int]


class RunArguments(TypedDict, total=False):
    """How a batch is run, as keyword arguments; see `RunOptions`."""

    initial: Rows | None
    warm: Truth
    chunk: Whole
    engine: "str | Executor | Any"
    workers: Whole | None
    shard: Shard | None
    progress: Truth


class BatchArguments(SolveArguments, RunArguments, total=False):
    """Options of `solve_batch` as keyword arguments."""


@dataclass(frozen=True)
class RunOptions:
    """How a batch is run; see `solve_batch`. All options are checked when it is made."""

    initial: Any = None
    warm: bool = False
    chunk: int = CHUNK
    engine: Any = "threads"
    workers: int | None = None
    shard: Shard | None = None
    progress: bool = False

    def __post_init__(self) -> None:
        values = {
            "warm": checks.truth("warm", self.warm),
            "chunk": checks.integer("chunk", self.chunk, 1, MOST_CHUNK),
            "workers": read_workers(self.workers),
            "shard": None if self.shard is None else _shard(self.shard),
            "progress": checks.truth("progress", self.progress),
        }
        for key, value in values.items():
            object.__setattr__(self, key, value)

    def owns(self, number: int) -> bool:
        """Whether a chunk belongs to this shard."""
        return self.shard is None or number % self.shard[1] == self.shard[0] - 1


def _shard(value: Any) -> Shard:
    wanted = "two whole numbers (I, N), I from 1 to N"
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise InputError("shard", "", value, wanted)
    count = checks.integer("shard", value[1], 1, MOST_SHARDS)
    return checks.integer("shard", value[0], 1, count), count


def solve_batch(
    robot: Robot,
    targets: str | Path | Mapping[str, Any] | GoalArrays | Rows,
    scene: SceneLike | None = None,
    out: str | Path | None = None,
    **options: Unpack[BatchArguments],
) -> Batch:
    """Solve independent targets of the tip in chunks, whatever their number.

    Each answer is that of `Solver.solve`, to the last bit, whatever the engine, the number of workers and what
    interrupted the call, unless the time of the solve runs out. Chunks that are done are kept in a folder beside `out`
    until all are: the same call goes on where an earlier one ended, and solves nothing twice.

    Parameters
    ----------
    robot : Robot
    targets : path, mapping of arrays, or array_like (m, 3)
        A table (`.csv`, `.npz`, `.parquet`), arrays by the names of `GoalArrays`, or positions. A row that is no target
        is reported by its number, and the others are solved.
    scene : Scene or list of obstacles, optional
    out : path, optional
        The table of results (`.csv`, `.npz`, `.parquet`); without it they stay in memory.
    initial : array_like (n, 3), optional
        Where every solve begins.
    warm : bool
        Whether seven of eight targets begin from the solution of a near target of the same chunk, so that results
        depend on `chunk`. It pays where a solve from nothing is slow, not for free poses.
    chunk : int
        Rows of a chunk: what is lost at most when a worker dies.
    engine : str, Executor or Client
        `threads`, `processes`, `dask` (workers on this machine), `tcp://...` of a Dask scheduler, a client of one, or
        any executor of `concurrent.futures`.
    workers : int, optional
        By default one a core.
    shard : (int, int), optional
        `(i, n)`: every n-th chunk from the i-th on, 1 = first. A call without it joins what all shards have done.
    progress : bool
        Whether to say on standard error how far it is.
    **options
        As for `Solver`, but `max_starts` is 100 and `time` 0.1 s by default: a table may hold many targets that nothing
        reaches.

    Returns
    -------
    Batch

    Raises
    ------
    InputError
        When an argument is not what it should be, or `out` was begun with another problem, version or size of chunks.
    UnfinishedError
        When it cannot go on: the disk is full, or the workers are gone. What is done is kept.
    """
    refuse_unknown(options, BatchArguments)
    given: dict[str, Any] = {"max_starts": STARTS, "time": TIME, **options}
    run = RunOptions(**{key: given.pop(key) for key in RunArguments.__annotations__ if key in given})
    file = None if out is None else Path(out)
    if file is not None:
        check_results("out", file)
    elif run.shard is not None:
        raise InputError("shard", "needs a file of results", run.shard, "out=, too")
    solver = Solver(robot, scene, **only_reading(given))
    initial = None if run.initial is None else checks.array("initial", run.initial, (len(robot), 3))
    work = Work(solver, initial, run.warm)
    with closing(open_source(targets)) as source:
        fingerprint = source.fingerprint()
        record = {} if file is None else _record(solver, f"{source.rows} rows, {fingerprint}", run, initial)
        results = Results(work.layout, source.rows, run.chunk, file, record)
        batch = results.finished() or _run(results, source, work, run)
    found = batch.results if file is None else file
    return batch if found is None else replace(batch, _answers=Answers(work, targets, fingerprint, run.chunk, found))


def _record(solver: Solver, targets: str, run: RunOptions, initial: Any) -> dict[str, Any]:
    """Return all that results depend on."""
    begun = "none" if initial is None else hash_of(initial.tobytes())
    return {
        **problem_record(solver.robot, solver.scene.snapshot(), solver.options),
        "initial": f"{begun}{', then near targets' if run.warm else ''}",
        "targets": targets,
        "chunk": run.chunk,
    }


def _run(results: Results, source: Source, work: Work, run: RunOptions) -> Batch:
    """Solve the chunks that are missing, and put all together."""
    missing = results.open()
    with _explained(results):
        began = clock.perf_counter()
        todo = [number for number in missing if run.owns(number)]
        failed = _solve(results, todo, source, work, run) if todo else []
        return results.end(failed, clock.perf_counter() - began, whole=run.shard is None)


def _solve(results: Results, todo: list[int], source: Source, work: Work, run: RunOptions) -> list[Failed]:
    """Solve chunks by an engine, which ends in any case."""

    def keep(task: Task, block: Block) -> None:
        results.write(task.number, block)
        bar.advance(len(block["row"]))

    def tasks() -> Iterator[Task]:
        for number in todo:
            first, last = results.span(number)
            yield Task(number, first, source.read(first, last))

    rows = sum(last - first for first, last in map(results.span, todo))
    with ProgressBar(rows if run.progress else 0, logged=run.progress) as bar:
        engine = begin(run.engine, work, run.workers or 1)
        dispatcher = Dispatcher(engine, tasks(), keep)
        done = False
        try:
            dispatcher.run()
            done = True
        finally:
            engine.close(now=not done)
    return dispatcher.failed


@contextmanager
def _explained(results: Results) -> Iterator[None]:
    """Say in one line what happened, and what is kept."""
    try:
        yield
    except InputError:
        results.discard()
        raise
    except LostError as error:
        raise UnfinishedError(f"{error}; {results.kept}") from None
    except OSError as error:
        why = error.strerror or str(error)
        raise UnfinishedError(f"{why}; {results.kept}") from error
