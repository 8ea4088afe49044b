"""`solve_batch`: any number of targets, through files or in memory; the same call goes on after any interruption.

Answers are kept chunk by chunk until they are all there; then they are one table.
"""

import time as clock
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Rows, Truth, Whole
from sinuous.base.documents import draft_of
from sinuous.base.entrance import warn_moved
from sinuous.base.errors import InputError, UnfinishedError, refuse_unknown
from sinuous.base.progress import ProgressBar
from sinuous.model.robot import Robot
from sinuous.problem.target import GoalArrays
from sinuous.scene.scene import SceneLike
from sinuous.solver.many import read_workers
from sinuous.solver.memory import only_reading
from sinuous.solver.options import SolveArguments
from sinuous.solver.solver import Solver
from sinuous.studies.batch.batch import Answers, Batch, ChunkSolver, Failed
from sinuous.studies.batch.tables.reading import Source, open_source
from sinuous.studies.batch.tables.results import (
    CODES,
    INVALID,
    SKIPPED,
    STATUSES,
    Layout,
    check_results,
    joined,
    write_results,
)
from sinuous.studies.runs.engine import (
    Arrays,
    Checkpoint,
    Failure,
    LostError,
    check_same,
    hash_of,
    problem_record,
    read_record,
    write_record,
)
from sinuous.studies.runs.engines import open_engine

MOST_INVALID = 1000
"""Rows that are no targets whose numbers are kept."""


class Results:
    """Answers in chunks of rows.

    Parameters
    ----------
    layout : Layout
    rows, chunk : int
        Rows of all, and of a chunk.
    out : Path, optional
        The table of results; without it they stay in memory.
    record : mapping of str to plain values
        All that the results depend on.
    """

    def __init__(
        self, layout: Layout, rows: int, chunk: int, out: Path | None = None, record: Mapping[str, Any] | None = None
    ) -> None:
        self._layout, self._rows, self._chunk = layout, rows, chunk
        self._out, self._record = out, record or {}
        self._chunks = Checkpoint(out, self._record, "this batch")
        self._count = -(-rows // chunk)
        self._before = 0
        self._done: set[int] = set()

    def finished(self) -> Batch | None:
        """Return what an earlier call has finished, if it had the same record.

        Raises
        ------
        InputError
            When the file of results is there, and is of something else.
        """
        if self._out is None or not self._out.exists() or self._chunks.begun:
            return None
        before = read_record(_record_of(self._out))
        if before is None or "counts" not in before:
            raise InputError("out", "is there already", str(self._out), "a file that is not there")
        check_same(before, self._record, _record_of(self._out), "this batch")
        rows = self._rows
        return Batch(self._out, rows, before["counts"], tuple(before["invalid"]), (), 0.0, rows, rows)

    def open(self) -> list[int]:
        """Begin, or go on; return the numbers of the chunks that are missing."""
        self._chunks.open()
        self._done = set(self._chunks.done())
        self._before = self._rows_of(self._done)
        return [number for number in range(self._count) if number not in self._done]

    def span(self, number: int) -> tuple[int, int]:
        """First row of a chunk, and the first one after it."""
        return number * self._chunk, min(self._rows, (number + 1) * self._chunk)

    def write(self, number: int, block: Arrays) -> None:
        """Keep a chunk, whose rows have no numbers yet."""
        self._chunks.write(number, {**block, "row": block["row"] + self.span(number)[0]})

    def discard(self) -> None:
        """Delete the folder of chunks, if no chunk is done."""
        if not self._chunks.done():
            self._chunks.remove()

    @property
    def kept(self) -> str:
        """What outlives a run that cannot go on, in words."""
        if self._out is None:
            return "nothing is kept without a file of results"
        done = f"{len(self._chunks.done())} of {self._count} chunks are kept in {self._chunks.folder}"
        return f"{done}; the same command goes on from there"

    def end(self, failures: Sequence[Failure], seconds: float, whole: bool) -> Batch:
        """Join all chunks, unless this was a shard; chunks stay where some were skipped, which can be tried again."""
        failed = tuple(Failed(each.number, *self._numbers(each.number), each.reason) for each in failures)
        batch = partial(Batch, self._out, failed=failed, seconds=seconds, before=self._before, total=self._rows)
        self._done = set(self._chunks.done())
        if not whole:
            return batch(rows=self._rows_of(self._done), counts={}, invalid=())
        if self._out is None:
            results = joined(self._blocks(), self._layout)
            counts, invalid = tally([results])
            return batch(rows=self._rows, counts=counts, invalid=invalid, results=results)
        counts, invalid = tally(self._blocks("row", "status"))
        with draft_of(self._out) as draft:
            write_results(draft, self._blocks, self._layout, self._rows)
        write_record(_record_of(self._out), {**self._record, "counts": counts, "invalid": invalid})
        if not failed:
            self._chunks.remove()
        return batch(rows=self._rows, counts=counts, invalid=invalid)

    def _blocks(self, *names: str) -> Iterator[Arrays]:
        """Yield all chunks in order, or these arrays of each; rows of a chunk that is missing were skipped."""
        for number in range(self._count):
            if number in self._done:
                yield self._chunks.read(number, *(names or self._layout.shapes))
            else:
                first, last = self.span(number)
                nothing = self._layout.nothing(first, last - first, SKIPPED)
                yield {name: nothing[name] for name in names or nothing}

    def _numbers(self, number: int) -> tuple[int, int]:
        """Numbers of the first row of a chunk and of its last, 1 = first of all."""
        first, last = self.span(number)
        return first + 1, last

    def _rows_of(self, numbers: Iterable[int]) -> int:
        return sum(last - first for first, last in map(self.span, numbers))


def tally(blocks: Iterable[Arrays]) -> tuple[dict[str, int], tuple[int, ...]]:
    """Count how rows ended, and find the numbers of those that are no targets, 1 = first."""
    counts: Counter[int] = Counter()
    invalid: list[int] = []
    for block in blocks:
        counts.update(dict(enumerate(np.bincount(block["status"], minlength=len(STATUSES)).tolist())))
        if len(invalid) < MOST_INVALID:
            invalid += block["row"][block["status"] == CODES[INVALID]].tolist()
    counted = {STATUSES[code]: count for code, count in counts.most_common() if count}
    return counted, tuple(invalid[:MOST_INVALID])


def _record_of(out: Path) -> Path:
    """Name of the file that says what a finished table was made of."""
    return out.with_name(out.name + ".json")


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
    given: dict[str, Any] = {"max_starts": DEFAULT_STARTS, "time": DEFAULT_SECONDS, **options}
    if given.pop("warm", None) is not None:
        warn_moved("solve_batch(warm=)", "solve_batch(memory=)", 3)
    refuse_unknown(given, SolveArguments.__annotations__)
    size = checks.integer("chunk", chunk, 1, MOST_CHUNK)
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
    work = ChunkSolver(solver, begun)
    with closing(open_source(targets)) as source:
        fingerprint = source.fingerprint()
        depends = {
            **problem_record(solver.robot, solver.scene.snapshot(), solver.options),
            "initial": "none" if begun is None else hash_of(begun.tobytes()),
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
