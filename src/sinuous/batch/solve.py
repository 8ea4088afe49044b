"""`solve_batch`: any number of targets, through files or in memory, and on after whatever ended it."""

import time as clock
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any, Unpack

from sinuous import checks
from sinuous.arguments import Rows
from sinuous.batch.batch import Batch
from sinuous.batch.conduct import Conductor, Failed
from sinuous.batch.engines.choose import begin
from sinuous.batch.engines.engine import LostError
from sinuous.batch.options import BatchArguments, RunArguments, RunOptions
from sinuous.batch.place import Files, Memory
from sinuous.batch.progress import Progress
from sinuous.batch.record import asked, record_of
from sinuous.batch.tables.blocks import Block
from sinuous.batch.tables.kinds import check_results, open_source
from sinuous.batch.tables.source import Source
from sinuous.batch.work import Task, Work
from sinuous.errors import InputError, UnfinishedError
from sinuous.problem.target import GoalArrays
from sinuous.robot.robot import Robot
from sinuous.scene.scene import SceneLike
from sinuous.solving.solver import Solver


def solve_batch(
    robot: Robot,
    targets: str | Path | Mapping[str, Any] | GoalArrays | Rows,
    scene: SceneLike | None = None,
    out: str | Path | None = None,
    **options: Unpack[BatchArguments],
) -> Batch:
    """Solve independent targets of the tip in chunks, whatever their number.

    Each answer is that of `Solver.solve`, to the last bit, whatever the engine, the number of workers and what
    interrupted it, unless its time runs out. Chunks that are done are kept in a folder beside `out` until all are: the
    same call goes on where an earlier one ended, and does nothing twice.

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
        As for `Solver`.

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
    given: dict[str, Any] = dict(options)
    run = RunOptions(**{key: given.pop(key) for key in RunArguments.__annotations__ if key in given})
    if out is not None:
        check_results("out", Path(out))
    elif run.shard is not None:
        raise InputError("shard", "needs a file of results", run.shard, "out= beside it")
    solver = Solver(robot, scene, **given)
    initial = None if run.initial is None else checks.array("initial", run.initial, (len(robot), 3))
    work = Work(solver, initial, run.warm)
    with closing(open_source(targets)) as source:
        if out is None:
            return _run(Memory(work.layout, source.rows, run.chunk), source, work, run)
        question = asked(solver.robot, solver.scene.snapshot(), solver.options)
        record = record_of(question, source, run.chunk, initial, run.warm)
        return _into(Files(work.layout, source.rows, Path(out), record), source, work, run)


def _into(files: Files, source: Source, work: Work, run: RunOptions) -> Batch:
    """Solve what is missing in files, unless nothing is."""
    before = files.finished()
    if before is not None:
        return before
    files.open()
    with _explained(files):
        return _run(files, source, work, run)


def _run(place: Memory | Files, source: Source, work: Work, run: RunOptions) -> Batch:
    """Solve what is missing, and put it together."""
    began = clock.perf_counter()
    todo = [number for number in place.missing() if run.own(number)]
    failed: list[Failed] = []
    if todo:
        rows = sum(last - first for first, last in map(place.span, todo))
        with Progress(rows, run.progress) as progress:

            def keep(task: Task, block: Block) -> None:
                place.write(task.number, block)
                progress.advance(len(block["row"]))

            failed = _solve(_tasks(todo, place, source), work, run, keep)
    return place.end(failed, clock.perf_counter() - began, whole=run.shard is None)


def _solve(tasks: Iterator[Task], work: Work, run: RunOptions, keep: Any) -> list[Failed]:
    """Give chunks to an engine, which ends in any case."""
    engine = begin(run.engine, work, run.workers or 1)
    conductor = Conductor(engine, tasks, keep)
    whole = False
    try:
        conductor.run()
        whole = True
    finally:
        engine.close(now=not whole)
    return conductor.failed


def _tasks(todo: list[int], place: Memory | Files, source: Source) -> Iterator[Task]:
    """Read chunks when they are asked for."""
    for number in todo:
        first, last = place.span(number)
        yield Task(number, first, source.read(first, last))


@contextmanager
def _explained(files: Files) -> Iterator[None]:
    """Say in one line what happened, and what is kept."""
    try:
        yield
    except InputError:
        files.forget()
        raise
    except LostError as error:
        raise UnfinishedError(f"{error}; {files.kept}; the same command goes on from there") from None
    except OSError as error:
        told = error.strerror or str(error)
        raise UnfinishedError(f"{told}; {files.kept}; the same command goes on from there") from error
