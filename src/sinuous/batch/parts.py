"""The chunks of a batch that are done: one file each, in a folder beside the file of results."""

import shutil
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.batch.record import RecordFile, check_same, draft_of
from sinuous.batch.tables.blocks import SKIPPED, Block, Layout
from sinuous.errors import InputError


class Parts:
    """A folder of chunks.

    A chunk is written under another name and then renamed, so that it is there whole or not at all.

    Parameters
    ----------
    folder : Path
    layout : Layout
    rows, chunk : int
        Rows of all, and of a chunk.
    """

    def __init__(self, folder: Path, layout: Layout, rows: int, chunk: int) -> None:
        self.folder, self._layout = folder, layout
        self._rows, self._chunk = rows, chunk
        self.count = -(-rows // chunk)

    def open(self, record: Mapping[str, Any]) -> None:
        """Make the folder, or go on with the one that is there.

        Raises
        ------
        InputError
            When it holds chunks of another batch, or cannot be written.
        """
        own = RecordFile(self.folder / "record.json")
        before = own.read()
        if before is not None:
            check_same(before, record, own.file)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            own.write(record)
        except OSError as error:
            wanted = "a place that can be written"
            raise InputError("out", f"cannot be written: {error.strerror}", str(self.folder), wanted) from None

    def span(self, number: int) -> tuple[int, int]:
        """First row of a chunk, and the first one after it."""
        return number * self._chunk, min(self._rows, (number + 1) * self._chunk)

    def done(self) -> list[int]:
        """Numbers of the chunks that are there; what is broken is taken away."""
        found = []
        for number in range(self.count):
            if self._file(number).exists():
                if zipfile.is_zipfile(self._file(number)):
                    found.append(number)
                else:  # a machine that lost its power
                    self._file(number).unlink()
        return found

    def write(self, number: int, block: Block) -> None:
        """Keep a chunk."""
        draft = draft_of(self._file(number))
        try:
            with draft.open("wb") as out:
                np.savez(out, **block)  # type: ignore[arg-type]
            draft.replace(self._file(number))
        except BaseException:
            draft.unlink(missing_ok=True)
            raise

    def blocks(self, name: str | None = None) -> Iterator[Block]:
        """Yield all chunks in order, or of each one array alone; what is not there is rows that were skipped."""
        for number in range(self.count):
            first, last = self.span(number)
            if not self._file(number).exists():
                nothing = self._layout.nothing(first, last - first, SKIPPED)
                yield nothing if name is None else {name: nothing[name]}
                continue
            with np.load(self._file(number)) as data:
                yield {key: data[key] for key in (self._layout.shapes if name is None else (name,))}

    def statuses(self) -> Iterator[Block]:
        """Yield rows and statuses of all chunks in order."""
        for row, status in zip(self.blocks("row"), self.blocks("status"), strict=True):
            yield row | status

    def remove(self) -> None:
        """Take the folder away."""
        shutil.rmtree(self.folder)

    def _file(self, number: int) -> Path:
        return self.folder / f"chunk-{number:07}.npz"
