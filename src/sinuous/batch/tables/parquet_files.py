"""Targets and results as Parquet, with pyarrow (the extra `batch`)."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.batch.tables.layout import STATUSES, Block, Layout
from sinuous.batch.tables.source import Raw, Source, groups_of
from sinuous.errors import InputError


def parquet(file: Path) -> Any:
    """Return the module that reads and writes it.

    Raises
    ------
    InputError
        When pyarrow is missing.
    """
    return checks.needed("pyarrow.parquet", "batch", "file", str(file), "pyarrow")


class ParquetSource(Source):
    """A Parquet file with the columns of `GROUPS`; others are left alone."""

    def __init__(self, file: Path) -> None:
        self._file = file
        try:
            self._table = parquet(file).ParquetFile(file)
        except ValueError as error:  # pyarrow's own are of this type
            raise InputError("file", str(error), str(file), "a Parquet file") from None
        self._groups = groups_of(self._table.schema_arrow.names)
        self.rows = self._table.metadata.num_rows
        self._batches: Any = None
        self._held: list[Any] = []
        self._at = 0

    def read(self, first: int, last: int) -> Raw:
        """Return rows `first` to `last`, the end not included; chunks are asked for in rising order."""
        columns = [name for names in self._groups.values() for name in names]
        if self._batches is None:
            self._batches = self._table.iter_batches(last - first, columns=columns)
        parts = []
        while self._at < last:
            batch = self._held.pop() if self._held else next(self._batches)
            skipped = max(0, min(len(batch), first - self._at))
            taken = min(len(batch) - skipped, last - self._at - skipped)
            parts.append(batch.slice(skipped, taken))
            self._at += skipped + taken
            if skipped + taken < len(batch):
                self._held.append(batch.slice(skipped + taken))
        return {key: np.stack([_column(parts, name) for name in names], axis=-1) for key, names in self._groups.items()}

    def close(self) -> None:
        """Close the file."""
        self._batches = None
        self._table.close()


def _column(parts: list[Any], name: str) -> Any:
    """Numbers of a column; what is missing is NaN."""
    try:
        arrays = [part.column(name).to_numpy(zero_copy_only=False).astype(np.float64) for part in parts]
    except (TypeError, ValueError):
        kind = str(parts[0].column(name).type)
        raise InputError(name, "", kind, "a column of numbers") from None
    return np.concatenate(arrays) if arrays else np.empty(0)


def write_parquet(file: Path, blocks: Iterable[Block], layout: Layout) -> None:
    """Write results, a row a target; a block is a row group."""
    module = parquet(file)
    import pyarrow  # noqa: PLC0415

    shapes = layout.shapes
    kinds = {name: pyarrow.from_numpy_dtype(dtype) for name, (dtype, shape) in shapes.items() if not shape}
    kinds["status"] = pyarrow.dictionary(pyarrow.int8(), pyarrow.string())
    schema = pyarrow.schema([(name, kinds.get(name, pyarrow.float64())) for name in layout.names])
    words = pyarrow.array(STATUSES)
    with module.ParquetWriter(file, schema) as out:
        for block in blocks:
            columns = [pyarrow.array(column, from_pandas=True) for column in layout.flat(block)]
            status = pyarrow.array(block["status"].astype(np.int8))
            columns[1] = pyarrow.DictionaryArray.from_arrays(status, words)
            out.write_table(pyarrow.Table.from_arrays(columns, schema=schema))
