"""Tables of targets, read a chunk at a time: CSV, NPZ and Parquet, by the ending of the name of a file, and arrays.

CSV is readable everywhere, and ten times as slow as the others. Parquet needs pyarrow (the extra `batch`).
"""

import zipfile
import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import islice
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.checks import Floats, few, readable
from sinuous.base.errors import InputError, is_meant, refuse_unknown, suggested, warn_of
from sinuous.base.text_tables import SAMPLED, axis_of, begins_with_count, filled_lines, tell_format
from sinuous.model.poses import any_rotations
from sinuous.problem.target import KEYS

GROUPS = {"positions": ("x", "y", "z"), "directions": ("dx", "dy", "dz"), "rotations": ("qw", "qx", "qy", "qz")}
"""Columns of a table, by the arrays that they make."""

COLUMNS = "columns x,y,z, or dx,dy,dz, or qw,qx,qy,qz, or x,y,z with one of the others"

SHAPES: dict[str, list[tuple[int, ...]]] = {
    "positions": [(3,)],
    "directions": [(3,)],
    "rotations": [(4,), (3, 3)],
    "xyzw": [(4,)],
}
"""Shapes that a row of each array may have."""

PIECE_SIZE = 1 << 24
"""Bytes of a file that are read at once."""

Raw = dict[str, Floats]
"""Rows by the names of `GoalArrays`, not checked yet: what is missing, or is no number, is NaN."""


class Source(ABC):
    """Targets in rows, by default those of a file."""

    rows: int
    _file: Path

    @abstractmethod
    def read(self, first: int, last: int) -> Raw:
        """Return rows `first` to `last`, the end not included; chunks are asked for in rising order."""

    def fingerprint(self) -> str:
        """Return a text that differs when the rows do: by default size and checksum of the file."""
        crc = size = 0
        with self._file.open("rb") as data:
            while piece := data.read(PIECE_SIZE):
                crc, size = zlib.crc32(piece, crc), size + len(piece)
        return f"{size} bytes, crc {crc:08x}"

    def close(self) -> None:  # noqa: B027
        """End reading."""


def _asked(key: str, names: Iterable[str]) -> list[str]:
    """Which of these arrays say what is asked: positions, one of the others, or both."""
    found = [each for each in KEYS if each in names]
    if not found or len([each for each in found if each != "positions"]) > 1:
        wanted = "arrays positions, directions, rotations or xyzw, or positions with one of the others"
        raise InputError(key, "", ",".join(names), wanted)
    return found


def _check_counts(key: str, counts: Mapping[str, int]) -> int:
    """Return how many rows all arrays have."""
    if len(set(counts.values())) > 1:
        raise InputError(key, "", dict(counts), "as many rows in each array")
    return next(iter(counts.values()))


def _check_shape(key: str, shape: tuple[int, ...]) -> None:
    """Refuse an array that has no rows of targets."""
    if shape[1:] not in SHAPES[key] or not shape:
        wanted = " or ".join("(" + ", ".join(["m", *map(str, each)]) + ")" for each in SHAPES[key])
        raise InputError(key, "", f"shape {shape}", f"an array {wanted}")


class ArraySource(Source):
    """Arrays by the names of `GoalArrays`; rows with NaN are let through, to be reported."""

    def __init__(self, arrays: Mapping[str, Any]) -> None:
        refuse_unknown(arrays, KEYS)
        given = {key: value for key, value in arrays.items() if value is not None}
        self._raw = {key: _rows(key, given[key]) for key in _asked("targets", given)}
        self.rows = _check_counts("targets", {key: len(rows) for key, rows in self._raw.items()})

    def read(self, first: int, last: int) -> Raw:
        """Return rows `first` to `last`, the end not included."""
        return {key: rows[first:last] for key, rows in self._raw.items()}

    def fingerprint(self) -> str:
        """Return a text that differs when the rows do."""
        crc = 0
        for key, rows in self._raw.items():
            crc = zlib.crc32(np.ascontiguousarray(rows).data, zlib.crc32(key.encode(), crc))
        return f"arrays of {self.rows} rows, crc {crc:08x}"


def _rows(key: str, value: Any) -> Floats:
    """An array of rows; of a `Rotation` of SciPy its matrices."""
    if hasattr(value, "as_matrix"):
        value = any_rotations(value, None, key)
    try:
        rows = np.array(value, np.float64)
    except (TypeError, ValueError):
        raise InputError(key, "", value, "rows of numbers") from None
    _check_shape(key, rows.shape)
    return rows


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
        return np.frombuffer(self._data.read(count * size), self._dtype)


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
        self.rows = _check_counts("arrays", {key: member.shape[0] for key, member in self._members.items()})

    def read(self, first: int, last: int) -> Raw:
        """Return rows `first` to `last`, the end not included."""
        return {key: member.read(first, last) for key, member in self._members.items()}

    def close(self) -> None:
        """Close the file."""
        for member in self._members.values():
            member.close()
        self._archive.close()


class NpzSource(NpzRows):
    """An NPZ file with arrays by the names of `GoalArrays`; that others are not read is said."""

    def __init__(self, file: Path) -> None:
        def choose(names: list[str]) -> list[str]:
            found = _asked("arrays", names)
            _tell_unread("array", names, KEYS)
            return found

        super().__init__(file, choose)
        for key, member in self._members.items():
            _check_shape(key, member.shape)


def _groups_of(names: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Find what a table asks by the names of its columns; that others are not read is said.

    Raises
    ------
    InputError
        When a column is missing, has the name of one that is meant, or a direction stands beside a quaternion.
    """
    found = {key: columns for key, columns in GROUPS.items() if set(columns) & set(names)}
    for columns in found.values():
        missing = [name for name in columns if name not in names]
        if missing:
            raise InputError("columns", f"there is no {', '.join(missing)}", ",".join(names), COLUMNS)
    if not found or {"directions", "rotations"} <= set(found):
        raise InputError("columns", "", ",".join(names), COLUMNS)
    twice = next((name for columns in found.values() for name in columns if list(names).count(name) > 1), None)
    if twice is not None:
        raise InputError("columns", f"{twice} is there twice", ",".join(names), COLUMNS)
    _tell_unread("column", names, [name for columns in GROUPS.values() for name in columns])
    return found


def _tell_unread(noun: str, names: Iterable[str], known: Sequence[str]) -> None:
    """Warn of what a table holds besides; names that mean others than they are, are refused."""
    unread, words = [name for name in names if name not in known], {*known, *(each.removesuffix("s") for each in known)}
    for name in unread:
        if is_meant(name, words):
            raise InputError(f"{noun}s", f"unknown {noun} {name!r}", name, suggested(name, words))
    if unread:
        warn_of([f"targets: {noun}s that are not read: {few(unread)}; known are {', '.join(known)}"])


def parquet(file: Path) -> Any:
    """Return the module that reads and writes it.

    Raises
    ------
    InputError
        When pyarrow is missing.
    """
    return checks.needed("pyarrow.parquet", "batch", "file", str(file), "pyarrow")


class ParquetSource(Source):
    """A Parquet file with the columns of `GROUPS`; that others are not read is said."""

    def __init__(self, file: Path) -> None:
        self._file = file
        try:
            self._table = parquet(file).ParquetFile(file)
        except ValueError as error:  # pyarrow's own are of this type
            raise InputError("file", str(error), str(file), "a Parquet file") from None
        self._groups = _groups_of(self._table.schema_arrow.names)
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
        raise InputError(name, "", str(parts[0].column(name).type), "a column of numbers") from None
    return np.concatenate(arrays) if arrays else np.empty(0)


class CsvSource(Source):
    """A text table with names of columns. A cell that is no finite number makes its row invalid, and no other."""

    def __init__(self, file: Path) -> None:
        self._file = file
        try:
            with file.open(encoding="utf-8-sig", newline=None) as text:
                lines = filled_lines(text)
                head = list(islice(lines, SAMPLED))
                counted = begins_with_count(head)
                self._table, rows = tell_format(head[counted:])
                self.rows = len(rows) + sum(1 for _ in lines)
        except UnicodeDecodeError:
            raise InputError("file", "is not UTF-8", str(file), "a CSV file") from None
        if counted and int(head[0][1]) != self.rows:
            raise InputError(f"line {head[0][0]}", "the count of rows is wrong", head[0][1], str(self.rows))
        names = [axis_of(name) or name for name in self._table.names or ()]
        groups = _groups_of(names)
        self._groups = {key: len(columns) for key, columns in groups.items()}
        self._places = [names.index(name) for columns in groups.values() for name in columns]
        self._table.warn_of_units(self._places, file)
        self._text = file.open(encoding="utf-8-sig", newline=None)
        self._lines = islice(filled_lines(self._text), len(head) - len(rows), None)
        self._at = 0

    def read(self, first: int, last: int) -> Raw:
        """Return rows `first` to `last`, the end not included; chunks are asked for in rising order."""
        lines = list(islice(self._lines, first - self._at, last - self._at))
        self._at = last
        numbers = self._table.read(lines, self._places, strict=False)
        parts = np.split(numbers, np.cumsum(list(self._groups.values()))[:-1], axis=1)
        return dict(zip(self._groups, parts, strict=True))

    def close(self) -> None:
        """Close the file."""
        self._text.close()


SOURCES: dict[str, Callable[[Path], Source]] = {".csv": CsvSource, ".npz": NpzSource, ".parquet": ParquetSource}
"""Kinds of tables, by the ending of the name of a file."""


def ending_of(key: str, file: Path) -> str:
    """Return the ending of the name of a table.

    Raises
    ------
    InputError
        When there is no such kind of table.
    """
    ending = file.suffix.lower()
    if ending not in SOURCES:
        raise InputError(key, "", str(file), "a name that ends in " + ", ".join(SOURCES))
    return ending


def open_source(targets: Any) -> Source:
    """Open a file of targets, or take arrays: a mapping by the names of `GoalArrays`, or positions (m, 3).

    Raises
    ------
    InputError
        When there is no such file, or it has not the columns.
    """
    if isinstance(targets, str | Path):
        file = Path(targets)
        ending = ending_of("targets", file)
        with readable(file, "targets"), checks.in_file(file):
            return SOURCES[ending](file)
    if isinstance(targets, Mapping):
        return ArraySource(targets)
    if hasattr(targets, "__array__") or isinstance(targets, list | tuple):
        return ArraySource({"positions": targets})
    raise InputError("targets", "", targets, "a file, a mapping of arrays, or positions")
