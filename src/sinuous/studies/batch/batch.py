"""The answers to all rows of a batch: chunk by chunk until they are all there, then one table, and a summary of it."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.arguments import Parameter, Rows, Stack
from sinuous.base.checks import Floats
from sinuous.base.documents import draft_of
from sinuous.base.errors import InputError
from sinuous.base.parameter_groups import read_tangent
from sinuous.base.reprs import ShortRepr
from sinuous.studies.batch.checkpoint import Checkpoint, InMemory, check_same, read_record, write_record
from sinuous.studies.batch.tables.kinds import NpzRows, joined, open_source, write_results
from sinuous.studies.batch.tables.layout import CODES, INVALID, SKIPPED, STATUSES, Block, Layout
from sinuous.studies.batch.work import ChunkSolver

if TYPE_CHECKING:
    from sinuous.answer.derivatives.many import Derivatives


NEEDED = ["status", "q", "clearance"]
"""What a table of results says of answers that are derived."""

SHOWN = 10
"""Rows without a target whose numbers are printed."""


class Failed(NamedTuple):
    """A chunk that was given up.

    Attributes
    ----------
    number, first, last : int
        Its number, and its rows, 1 = first of all.
    why : str
        What its last try ended with.
    """

    number: int
    first: int
    last: int
    why: str


@dataclass(frozen=True)
class Answers:
    """Where the answers of a batch are, and what they answer.

    Attributes
    ----------
    work : ChunkSolver
    targets : path, mapping of arrays, or array_like
    fingerprint : str
        Of the targets that were solved.
    chunk : int
        Rows of a chunk.
    found : Path or dict
        The table of results, or arrays by their names.
    """

    work: ChunkSolver
    targets: Any
    fingerprint: str
    chunk: int
    found: Path | Block

    def derivatives(self, wrt: tuple[Parameter, ...]) -> "Iterator[Derivatives]":
        """Derive one chunk after the other."""
        with closing(open_source(self.targets)) as source, _reader(self.found) as read:
            if source.fingerprint() != self.fingerprint:
                given = str(self.targets) if isinstance(self.targets, Path | str) else "arrays"
                raise InputError("targets", "have changed since they were solved", given, "those of this batch")
            for first in range(0, source.rows, self.chunk):
                span = first, min(source.rows, first + self.chunk)
                yield self.work.derive(source.read(*span), read(*span), wrt)


@contextmanager
def _reader(found: Path | Block) -> Iterator[Callable[[int, int], Block]]:
    """Yield what reads rows of results, from the first up to, without it, the last."""
    if not isinstance(found, Path):
        yield lambda first, last: {name: rows[first:last] for name, rows in found.items()}
        return
    if found.suffix.lower() != ".npz":
        raise InputError("out", "cannot be derived", str(found), "results as .npz, or in memory")
    with closing(NpzRows(found, lambda _: NEEDED)) as rows:
        yield rows.read


@dataclass(frozen=True, eq=False, repr=False)
class Batch(ShortRepr):
    """The summary of a batch.

    Attributes
    ----------
    file : Path or None
        The table of results.
    rows : int
        How many rows are done.
    counts : dict
        How many rows ended how: statuses of `Solution`, `invalid` (no target), `skipped` (their chunk failed three
        times).
    invalid : tuple of int
        Numbers of the rows that are no targets, 1 = first; at most the first thousand.
    failed : tuple of Failed
        Chunks that were given up.
    seconds : float
        Duration of this call.
    before : int
        Rows that an earlier call had done.
    total : int
        Number of all rows; greater than `rows` after a shard.
    results : dict or None
        Without a file: arrays over all rows by name: `q` (m, n, 3), `status` (m,), see `words`, and the others.
    """

    file: Path | None
    rows: int
    counts: Mapping[str, int]
    invalid: tuple[int, ...]
    failed: tuple[Failed, ...]
    seconds: float
    before: int
    total: int
    results: Block | None = field(default=None)
    _answers: Answers | None = field(default=None)

    words = STATUSES
    """The status that each number in `status` stands for."""

    @property
    def solved(self) -> bool:
        """Whether every row is solved."""
        return self.counts.get("solved", 0) == self.total

    @property
    def rate(self) -> float:
        """Rows a second of this call."""
        return (self.rows - self.before) / self.seconds if self.seconds > 0.0 else 0.0

    def derivatives(self, wrt: Parameter | Sequence[Parameter] = ("target",)) -> "Iterator[Derivatives]":
        """Derive all answers, a chunk of rows at a time and in their order, as `Solutions.derivative` does.

        It takes microseconds a row, less than to write derivatives and to read them again; so no table holds them.

        Parameters
        ----------
        wrt : str or sequence of str
            Groups of parameters.

        Yields
        ------
        Derivatives
            Of the rows of a chunk; NaN where a row is not solved, or is no target.

        Raises
        ------
        InputError
            When there is no such group, the results are in another file than `.npz`, shards are missing, or the targets
            have changed.
        """
        from sinuous.answer.derivatives.parameters import read_wrt  # noqa: PLC0415

        if self._answers is None or self.rows < self.total:
            raise InputError("batch", "is not whole", f"{self.rows} of {self.total} rows", "one with all rows")
        return self._answers.derivatives(read_wrt(wrt))

    def vjp(self, cotangent: Stack, wrt: Parameter | Sequence[Parameter] = ("target",)) -> "dict[Parameter, Floats]":
        """Derivatives (m, p) of `sum(cotangent * q)` of each row by each group, for cotangents (m, n, 3).

        Of a robot, a base or obstacles that all rows have in common the sum over the rows counts. An array on disk
        (`numpy.load` with `mmap_mode`) is read a chunk at a time.

        Raises
        ------
        InputError
            As for `derivatives`, or when the cotangents have another shape.
        """
        given = self._by_rows("cotangent", cotangent)
        parts = [part.vjp(given[rows]) for rows, part in self._spans(wrt)]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def jvp(self, tangent: Rows | Mapping[Parameter, Rows]) -> Floats:
        """Motions (m, n, 3) of the configurations when the parameters of each row move along tangents (m, p).

        Raises
        ------
        InputError
            As for `derivatives`, or when a tangent has another shape.
        """
        given = read_tangent(tangent, tuple(tangent) if isinstance(tangent, Mapping) else ("target",))
        ways = {name: self._by_rows(f"tangent[{name!r}]", way) for name, way in given.items()}
        spans = self._spans(tuple(ways))
        motions = [part.jvp({name: way[rows] for name, way in ways.items()}) for rows, part in spans]
        return np.concatenate(motions)

    def _spans(self, wrt: Any) -> "Iterator[tuple[slice, Derivatives]]":
        """Rows of each chunk, and the derivatives of their answers."""
        first = 0
        for part in self.derivatives(wrt):
            yield slice(first, first + len(part)), part
            first += len(part)

    def _by_rows(self, key: str, value: Any) -> NDArray[Any]:
        """An array with a row for each of the batch; what is on disk stays there."""
        try:
            given = np.asanyarray(value)
        except ValueError:
            raise InputError(key, "", value, "an array of numbers") from None
        if given.shape[:1] != (self.total,):
            raise InputError(key, "", f"shape {given.shape}", f"one for each row: {self.total}")
        return given

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, without the results."""
        return {
            "file": None if self.file is None else str(self.file),
            "rows": self.rows,
            "total": self.total,
            "before": self.before,
            "counts": dict(self.counts),
            "invalid": list(self.invalid),
            "failed": [each._asdict() for each in self.failed],
            "seconds": self.seconds,
        }

    def _shown(self) -> Iterator[str]:
        yield f"{self.rows:,} rows"
        yield from (f"{count:,} {name}" for name, count in self.counts.items())

    def __str__(self) -> str:
        ended = ", ".join(f"{count:,} {name}" for name, count in self.counts.items())
        done = f"{self.rows:,} rows" if self.rows == self.total else f"{self.rows:,} of {self.total:,} rows"
        parts = [f"Batch: {done}{': ' if ended else ''}{ended}"]
        if self.counts.get(INVALID):
            numbers = ", ".join(map(str, self.invalid[:SHOWN]))
            more = ", ..." if self.counts[INVALID] > SHOWN else ""
            parts.append(f"  invalid    rows {numbers}{more}")
        parts += [f"  skipped    rows {each.first} to {each.last}: {each.why}" for each in self.failed]
        if self.rows > self.before:
            parts.append(f"  effort     {self.seconds:.3g} s, {self.rate:,.0f} rows a second")
        if self.before:
            parts.append(f"  before     {self.before:,} rows were done by an earlier call")
        if self.file is not None and self.rows == self.total:
            parts.append(f"  results    {self.file}")
        return "\n".join(parts)


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
        self._chunks: InMemory | Checkpoint = InMemory() if out is None else Checkpoint(out, self._record, "this batch")
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

    def write(self, number: int, block: Block) -> None:
        """Keep a chunk."""
        self._chunks.write(number, block)

    def discard(self) -> None:
        """Delete the folder of chunks, if no chunk is done."""
        if not self._chunks.done():
            self._chunks.remove()

    @property
    def kept(self) -> str:
        """What outlives a run that cannot go on, in words."""
        if isinstance(self._chunks, InMemory):
            return "nothing is kept without a file of results"
        done = f"{len(self._chunks.done())} of {self._count} chunks are kept in {self._chunks.folder}"
        return f"{done}; the same command goes on from there"

    def end(self, failed: Sequence[Failed], seconds: float, whole: bool) -> Batch:
        """Join all chunks, unless this was a shard; chunks stay where some were skipped, which can be tried again."""
        batch = partial(Batch, self._out, failed=tuple(failed), seconds=seconds, before=self._before, total=self._rows)
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

    def _blocks(self, *names: str) -> Iterator[Block]:
        """Yield all chunks in order, or these arrays of each; the next one is read meanwhile."""
        chunks = self._each(*names)
        with ThreadPoolExecutor(1) as reader:
            coming = reader.submit(next, chunks, None)
            while (block := coming.result()) is not None:
                coming = reader.submit(next, chunks, None)
                yield block

    def _each(self, *names: str) -> Iterator[Block]:
        """Yield all chunks in order, or these arrays of each; rows of a chunk that is missing were skipped."""
        for number in range(self._count):
            if number in self._done:
                yield self._chunks.read(number, *(names or self._layout.shapes))
            else:
                first, last = self.span(number)
                nothing = self._layout.nothing(first, last - first, SKIPPED)
                yield {name: nothing[name] for name in names or nothing}

    def _rows_of(self, numbers: Iterable[int]) -> int:
        return sum(last - first for first, last in map(self.span, numbers))


def tally(blocks: Iterable[Block]) -> tuple[dict[str, int], tuple[int, ...]]:
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
