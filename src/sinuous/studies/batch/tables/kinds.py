"""Tables of targets and results; the ending of the name of a file says of which kind it is.

CSV is readable everywhere, and ten times as slow as the others. Parquet needs pyarrow (the extra `batch`).
"""

import csv
import warnings
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import islice
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.documents import readable
from sinuous.base.errors import InputError
from sinuous.files.documents import NUMBER
from sinuous.problem.target import KEYS
from sinuous.studies.batch.tables.layout import STATUSES, Block, Layout
from sinuous.studies.batch.tables.source import ArraySource, Raw, Source, checked_shape, groups_of


class _Member:
    """One array of an NPZ file, of which rows are read."""

    def __init__(self, archive: zipfile.ZipFile, key: str) -> None:
        self._data = archive.open(f"{key}.npy")
        try:
            header = npy.read_array_header_1_0 if npy.read_magic(self._data)[0] == 1 else npy.read_array_header_2_0
            self.shape, self._columns_first, self._dtype = header(self._data)
        except ValueError as error:
            raise InputError(key, str(error), key, "an array as numpy.savez writes it") from None
        self._begin = self._data.tell()
        if self._dtype.kind not in "iuf":
            raise InputError(key, "", str(self._dtype), "an array of numbers")

    def read(self, first: int, last: int) -> Floats:
        """Return rows (last - first, ...)."""
        own, count = self.shape[1:], last - first
        if not self._columns_first:
            rows = self._numbers(first * prod(own), count * prod(own)).reshape(count, *own)
        else:
            columns = [self._numbers(k * self.shape[0] + first, count) for k in range(prod(own))]
            rows = np.stack(columns, axis=-1).reshape(count, *own[::-1])
            rows = rows.transpose(0, *range(len(own), 0, -1))
        return np.ascontiguousarray(rows, np.float64)

    def close(self) -> None:
        """End reading."""
        self._data.close()

    def _numbers(self, first: int, count: int) -> NDArray[Any]:
        size = self._dtype.itemsize
        self._data.seek(self._begin + first * size)
        data = self._data.read(count * size)
        return np.frombuffer(data, self._dtype)


class NpzRows(Source):
    """Arrays with equally many rows of an NPZ file.

    Parameters
    ----------
    file : Path
    choose : callable
        Of all names in the file those of the arrays that are read.
    """

    def __init__(self, file: Path, choose: Callable[[list[str]], list[str]]) -> None:
        self._file = file
        try:
            self._archive = archive = zipfile.ZipFile(file)
        except zipfile.BadZipFile:
            raise InputError("file", "is no NPZ file", str(file), "arrays as numpy.savez writes them") from None
        found = choose([name.removesuffix(".npy") for name in archive.namelist()])
        self._members = {key: _Member(archive, key) for key in found}
        counts = {key: member.shape[0] for key, member in self._members.items()}
        if len(set(counts.values())) > 1:
            raise InputError("arrays", "", counts, "as many rows in each array")
        self.rows = counts[found[0]]

    def read(self, first: int, last: int) -> Raw:
        """Return rows `first` to `last`, the end not included."""
        return {key: member.read(first, last) for key, member in self._members.items()}

    def close(self) -> None:
        """Close the file."""
        for member in self._members.values():
            member.close()
        self._archive.close()


class NpzSource(NpzRows):
    """An NPZ file with arrays by the names of `GoalArrays`; what else is in it is left alone."""

    def __init__(self, file: Path) -> None:
        super().__init__(file, _asked)
        for key, member in self._members.items():
            checked_shape(key, member)


def _asked(names: list[str]) -> list[str]:
    """Which arrays say what is asked."""
    found = [key for key in KEYS if key in names]
    if not found or len([key for key in found if key != "positions"]) > 1:
        wanted = "arrays positions, directions, rotations or xyzw, or positions with one of the others"
        raise InputError("arrays", "", ",".join(names), wanted)
    return found


def write_npz(file: Path, blocks: Callable[..., Iterable[Block]], layout: Layout, rows: int) -> None:
    """Write results: an array for each name of `Layout.shapes`, and the words that its numbers stand for.

    `blocks` is called with the name of each array and yields that array of all blocks: one is written after the other.
    """
    texts = {"statuses": STATUSES, "segment_names": layout.segments, "actuator_names": layout.actuators}
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, words in texts.items():
            _write(archive, name, iter([np.array(words, np.str_)]))
        for name, (dtype, shape) in layout.shapes.items():
            columns = (np.asarray(block[name], dtype) for block in blocks(name))
            _write(archive, name, columns, (dtype, (rows, *shape)))


def _write(
    archive: zipfile.ZipFile,
    name: str,
    columns: Iterator[NDArray[Any]],
    whole: tuple[np.dtype[Any], tuple[int, ...]] | None = None,
) -> None:
    """Write an array that comes in pieces; its date is always the same, so that equal results are equal files."""
    with archive.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as member:
        if whole is None:
            npy.write_array(member, next(columns), allow_pickle=False)
            return
        dtype, shape = whole
        header = {"descr": npy.dtype_to_descr(dtype), "fortran_order": False, "shape": shape}
        npy.write_array_header_2_0(member, header)
        for column in columns:
            member.write(np.ascontiguousarray(column).data.cast("B") if column.size else b"")


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


class CsvSource(Source):
    """A CSV file with a header. A cell that is no finite number makes its row invalid, and no other."""

    def __init__(self, file: Path) -> None:
        self._file = file
        try:
            with file.open(encoding="utf-8-sig", newline=None) as text:
                header = next((line for line in text if line.strip()), "")
                self.rows = sum(1 for line in text if line.strip())
        except UnicodeDecodeError:
            raise InputError("file", "is not UTF-8", str(file), "a CSV file") from None
        names = [name.strip() for name in next(csv.reader([header]), [])]
        groups = groups_of(names)
        self._groups = {key: len(columns) for key, columns in groups.items()}
        self._places = [names.index(name) for columns in groups.values() for name in columns]
        self._text = file.open(encoding="utf-8-sig", newline=None)
        self._lines = (line for line in self._text if line.strip())
        next(self._lines, None)
        self._at = 0

    def read(self, first: int, last: int) -> Raw:
        """Return rows `first` to `last`, the end not included; chunks are asked for in rising order."""
        lines = list(islice(self._lines, first - self._at, last - self._at))
        self._at = last
        cells = _cells(lines, self._places)
        ends = np.cumsum(list(self._groups.values()))
        return {key: cells[:, end - self._groups[key] : end] for key, end in zip(self._groups, ends, strict=True)}

    def close(self) -> None:
        """Close the file."""
        self._text.close()


def _cells(lines: list[str], places: Sequence[int]) -> Floats:
    """Read the cells of these columns: all together, or where something is no number one by one."""
    if not lines:
        return np.empty((0, len(places)))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            read = np.loadtxt(lines, delimiter=",", usecols=places, ndmin=2, comments=None, quotechar='"')
    except (ValueError, UserWarning):
        return np.array([[_number(row, place) for place in places] for row in csv.reader(lines)])
    return read


def _number(row: list[str], place: int) -> float:
    cell = row[place].strip() if place < len(row) else ""
    return float(cell) if NUMBER.fullmatch(cell) else np.nan


def write_csv(file: Path, blocks: Iterable[Block], layout: Layout) -> None:
    """Write results, a row a target; what is not known is an empty cell."""
    with file.open("w", encoding="utf-8", newline="") as out:
        table = csv.writer(out, lineterminator="\n")
        table.writerow(layout.names)
        for block in blocks:
            columns = [_listed(column) for column in layout.flat(block)]
            table.writerows(zip(*columns, strict=True))


def _listed(column: np.ndarray) -> list[object]:
    """Values as Python has them; NaN is nothing."""
    values: list[object] = column.tolist()
    if column.dtype.kind == "f" and np.isnan(column).any():
        return [None if missing else value for value, missing in zip(values, np.isnan(column).tolist(), strict=True)]
    return values


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
        with readable(file, "targets"), checks.in_file(file):
            return SOURCES[ending](file)
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
