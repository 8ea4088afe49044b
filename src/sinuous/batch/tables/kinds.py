"""Kinds of tables of targets and results: the ending of the name of a file says which one it is."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.batch.tables.csv_files import CsvSource, write_csv
from sinuous.batch.tables.layout import Block, Layout
from sinuous.batch.tables.npz_files import NpzSource, write_npz
from sinuous.batch.tables.parquet_files import ParquetSource, parquet, write_parquet
from sinuous.batch.tables.source import ArraySource, Source
from sinuous.errors import InputError

SOURCES: dict[str, Callable[[Path], Source]] = {".csv": CsvSource, ".npz": NpzSource, ".parquet": ParquetSource}

ENDINGS = "a name that ends in " + ", ".join(SOURCES)


def open_source(targets: Any) -> Source:
    """Open a file of targets, or take arrays: a mapping by the names of `GoalArrays`, or positions (m, 3).

    Raises
    ------
    InputError
        When there is no such file, or it has not the columns.
    """
    if isinstance(targets, str | Path):
        file = Path(targets)
        ending = _ending("targets", file)
        try:
            return SOURCES[ending](file)
        except OSError as error:
            raise InputError("targets", f"cannot be read: {error.strerror}", str(file), "a table of targets") from None
        except InputError as error:
            raise error.in_file(file) from None
    if isinstance(targets, Mapping):
        return ArraySource(targets)
    if hasattr(targets, "__array__") or isinstance(targets, list | tuple):
        return ArraySource({"positions": targets})
    raise InputError("targets", "", targets, "a file, a mapping of arrays, or positions")


def check_results(key: str, file: Path) -> None:
    """Refuse a file of results that could not be written at the end.

    Raises
    ------
    InputError
        When its ending is not known, or pyarrow is missing.
    """
    if _ending(key, file) == ".parquet":
        parquet(file)


def write_results(file: Path, blocks: Callable[..., Iterable[Block]], layout: Layout, rows: int) -> None:
    """Write results of the kind that the ending says.

    `blocks` gives all blocks anew at each call; given the name of an array, that array of each alone.
    """
    match file.suffix.lower():
        case ".csv":
            write_csv(file, blocks(), layout)
        case ".parquet":
            write_parquet(file, blocks(), layout)
        case _:
            write_npz(file, blocks, layout, rows)


def joined(blocks: Iterable[Block], layout: Layout) -> Block:
    """Put blocks together in memory."""
    parts = [layout.nothing(0, 0, "skipped"), *blocks]
    return {name: np.concatenate([part[name] for part in parts]) for name in layout.shapes}


def _ending(key: str, file: Path) -> str:
    ending = file.suffix.lower()
    if ending not in SOURCES:
        raise InputError(key, "", str(file), ENDINGS)
    return ending
