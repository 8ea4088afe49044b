"""Where answers are kept: in memory, or in files that outlive whatever happens."""

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from sinuous.batch.batch import Batch
from sinuous.batch.conduct import Failed
from sinuous.batch.parts import Parts
from sinuous.batch.record import RecordFile, check_same, draft_of
from sinuous.batch.tables.blocks import CODES, INVALID, SKIPPED, STATUSES, Block, Layout
from sinuous.batch.tables.kinds import joined, write_results
from sinuous.errors import InputError

MOST_INVALID = 1000
"""Rows that are no targets whose numbers are kept."""


class Place(Protocol):
    """Keeps the answers of chunks."""

    def missing(self) -> list[int]:
        """Return the numbers of the chunks that are not there."""
        ...

    def span(self, number: int) -> tuple[int, int]:
        """First row of a chunk, and the first one after it."""
        ...

    def write(self, number: int, block: Block) -> None:
        """Keep a chunk."""
        ...

    def end(self, failed: Sequence[Failed], seconds: float, whole: bool) -> Batch:
        """Sum up; with `whole`, all rows are put together."""
        ...


class Memory:
    """Keeps answers in memory."""

    def __init__(self, layout: Layout, rows: int, chunk: int) -> None:
        self._layout, self._rows = layout, rows
        self._spans = [(first, min(rows, first + chunk)) for first in range(0, rows, chunk)]
        self._blocks: dict[int, Block] = {}

    def missing(self) -> list[int]:
        """All."""
        return list(range(len(self._spans)))

    def span(self, number: int) -> tuple[int, int]:
        """First row of a chunk, and the first one after it."""
        return self._spans[number]

    def write(self, number: int, block: Block) -> None:
        """Keep a chunk."""
        self._blocks[number] = block

    def end(self, failed: Sequence[Failed], seconds: float, whole: bool) -> Batch:
        """Put all together."""
        spans = enumerate(self._spans)
        blocks = (self._blocks.get(i, self._layout.nothing(a, b - a, SKIPPED)) for i, (a, b) in spans)
        results = joined(blocks, self._layout)
        counts, invalid = tally([results])
        return Batch(None, self._rows, counts, invalid, tuple(failed), seconds, 0, self._rows, results)


class Files:
    """Keeps chunks in a folder, and joins them into a table; a record beside it says what it was made of."""

    def __init__(self, layout: Layout, rows: int, out: Path, record: dict[str, Any]) -> None:
        self._layout, self._rows, self._out, self._record = layout, rows, out, record
        self._parts = Parts(out.with_name(out.name + ".parts"), layout, rows, record["chunk"])
        self._own = RecordFile(out.with_name(out.name + ".json"))
        self._before = 0

    def finished(self) -> Batch | None:
        """Return what an earlier call has finished, if it was asked the same.

        Raises
        ------
        InputError
            When the file of results is there, and is of something else.
        """
        if not self._out.exists() or self._parts.folder.exists():
            return None
        before = self._own.read()
        if before is None or "counts" not in before:
            raise InputError("out", "is there already", str(self._out), "a file that is not there")
        check_same(before, self._record, self._own.file)
        rows = self._rows
        return Batch(self._out, rows, before["counts"], tuple(before["invalid"]), (), 0.0, rows, rows)

    def open(self) -> None:
        """Make the folder of chunks, or go on with the one that is there."""
        self._parts.open(self._record)

    def forget(self) -> None:
        """Take the folder away, if no chunk was done."""
        if not self._parts.done():
            self._parts.remove()

    def missing(self) -> list[int]:
        """Return the numbers of the chunks that are not there."""
        done = set(self._parts.done())
        self._before = sum(b - a for a, b in map(self.span, done))
        return [number for number in range(self._parts.count) if number not in done]

    def span(self, number: int) -> tuple[int, int]:
        """First row of a chunk, and the first one after it."""
        return self._parts.span(number)

    def write(self, number: int, block: Block) -> None:
        """Keep a chunk."""
        self._parts.write(number, block)

    @property
    def kept(self) -> str:
        """What is done, in words."""
        return f"{len(self._parts.done())} of {self._parts.count} chunks are kept in {self._parts.folder}"

    def end(self, failed: Sequence[Failed], seconds: float, whole: bool) -> Batch:
        """Join all chunks, unless this was a shard; the chunks stay where some were skipped, to be tried again."""
        if not whole:
            rows = sum(b - a for a, b in map(self.span, self._parts.done()))
            return Batch(self._out, rows, {}, (), tuple(failed), seconds, self._before, self._rows)
        counts, invalid = tally(self._parts.statuses())
        draft = draft_of(self._out)
        try:
            write_results(draft, self._parts.blocks, self._layout, self._rows)
            draft.replace(self._out)
        except BaseException:
            draft.unlink(missing_ok=True)
            raise
        batch = Batch(self._out, self._rows, counts, invalid, tuple(failed), seconds, self._before, self._rows)
        self._own.write(self._record | {"counts": batch.counts, "invalid": invalid})
        if not failed:
            self._parts.remove()
        return batch


def tally(blocks: Iterable[Block]) -> tuple[dict[str, int], tuple[int, ...]]:
    """Count how rows ended, and find those that are no targets, 1 = first."""
    counts: Counter[int] = Counter()
    invalid: list[int] = []
    for block in blocks:
        counts.update(dict(enumerate(np.bincount(block["status"], minlength=len(STATUSES)).tolist())))
        if len(invalid) < MOST_INVALID:
            invalid += block["row"][block["status"] == CODES[INVALID]].tolist()
    told = {STATUSES[code]: count for code, count in counts.most_common() if count}
    return told, tuple(invalid[:MOST_INVALID])
