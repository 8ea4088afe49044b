"""`solve_batch`: any number of targets, through files or in memory; the same call goes on after any interruption."""

import time as clock
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Unpack

from sinuous.base import checks
from sinuous.base.arguments import Rows, Truth, Whole
from sinuous.base.errors import InputError, UnfinishedError, refuse_unknown
from sinuous.base.progress import ProgressBar
from sinuous.model.robot import Robot
from sinuous.problem.target import GoalArrays
from sinuous.scene.scene import SceneLike
from sinuous.solver.many import read_workers
from sinuous.solver.memory import only_reading
from sinuous.solver.options import SolveArguments
from sinuous.solver.solver import Solver
from sinuous.studies.batch.batch import Answers, Batch
from sinuous.studies.batch.results import Results
from sinuous.studies.batch.tables.reading import Source, open_source
from sinuous.studies.batch.tables.results import check_results
from sinuous.studies.batch.work import ChunkSolver
from sinuous.studies.runs.checkpoint import hash_of, problem_record
from sinuous.studies.runs.engine import Failure, LostError
from sinuous.studies.runs.open_engine import open_engine

DEFAULT_STARTS, DEFAULT_SECONDS = 100, 0.1
"""Most starts of a target, by default."""

DEFAULT_CHUNK = 10_000
"""Rows of a chunk by default."""

MOST_CHUNK = 10_000_000
"""Most rows of a chunk."""

MOST_SHARDS = 1_000_000
"""Most shards of a batch."""

Shard = tuple[int, int]


def owns(shard: Shard | None, number: int) -> bool:
    """Whether a chunk belongs to a shard."""
    return shard is None or number % shard[1] == shard[0] - 1


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
    *,
    columns: Sequence[str] | None = None,
    initial: Rows | None = None,
    warm: Truth = False,
    chunk: Whole = DEFAULT_CHUNK,
    engine: object = "threads",
    workers: Whole | None = None,
    shard: Shard | None = None,
    progress: Truth = False,
    **options: Unpack[SolveArguments],
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
    columns : sequence of str, optional
        Names of the columns of a `.csv` or `.parquet` after `row` and `status`, in this order, such as those of the
        motors; by default all.
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
    refuse_unknown(options, SolveArguments.__annotations__)
    given: dict[str, Any] = {"max_starts": DEFAULT_STARTS, "time": DEFAULT_SECONDS, **options}
    near, size = checks.truth("warm", warm), checks.integer("chunk", chunk, 1, MOST_CHUNK)
    count, part = read_workers(workers), None if shard is None else _shard(shard)
    shown, file = checks.truth("progress", progress), None if out is None else Path(out)
    if file is not None:
        check_results("out", file, columns)
    elif columns is not None:
        raise InputError("columns", "needs a file of results", columns, "out=, too")
    elif part is not None:
        raise InputError("shard", "needs a file of results", part, "out=, too")
    solver = Solver(robot, scene, **only_reading(given))
    begun = None if initial is None else robot._one_configuration("initial", initial)
    work = ChunkSolver(solver, begun, near)
    with closing(open_source(targets)) as source:
        fingerprint = source.fingerprint()
        start = "none" if begun is None else hash_of(begun.tobytes())
        depends = {
            **problem_record(solver.robot, solver.scene.snapshot(), solver.options),
            "initial": f"{start}{', then near targets' if near else ''}",
            "targets": f"{source.rows} rows, {fingerprint}",
            "chunk": size,
            **({} if columns is None else {"columns": list(columns)}),
        }
        results = Results(work.layout.choosing(columns), source.rows, size, file, {} if file is None else depends)
        batch = results.finished()
        if batch is None:
            todo = [number for number in results.open() if owns(part, number)]
            with _explained(results):
                began = clock.perf_counter()
                failures = _solve(results, todo, source, engine, work, count, shown) if todo else []
                batch = results.end(failures, clock.perf_counter() - began, whole=part is None)
    found = batch.results if file is None else file
    return batch if found is None else replace(batch, _answers=Answers(work, targets, fingerprint, size, found))


def _solve(
    results: Results, todo: list[int], source: Source, engine: object, work: ChunkSolver, workers: int, shown: bool
) -> list[Failure]:
    """Solve chunks by an engine; return those that were given up."""
    rows = sum(last - first for first, last in map(results.span, todo))
    tasks = ((number, source.read(*results.span(number))) for number in todo)
    with ProgressBar(rows if shown else 0, logged=shown) as bar, open_engine(engine, work, workers) as crew:
        for number, block in crew.run(tasks):
            results.write(number, block)
            bar.advance(len(block["row"]))
    return crew.failures


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
