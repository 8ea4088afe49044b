"""The answers to all rows of a batch: chunk by chunk until they are all there, then one table."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.base.documents import draft_of
from sinuous.base.errors import InputError
from sinuous.studies.batch.batch import Batch, Failed
from sinuous.studies.batch.tables.results import CODES, INVALID, SKIPPED, STATUSES, Layout, joined, write_results
from sinuous.studies.runs.checkpoint import Checkpoint, check_same, read_record, write_record
from sinuous.studies.runs.engine import Arrays, Failure

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
        """Yield all chunks in order, or these arrays of each; the next one is read meanwhile."""
        chunks = self._each(*names)
        with ThreadPoolExecutor(1) as reader:
            coming = reader.submit(next, chunks, None)
            while (block := coming.result()) is not None:
                coming = reader.submit(next, chunks, None)
                yield block

    def _each(self, *names: str) -> Iterator[Arrays]:
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
