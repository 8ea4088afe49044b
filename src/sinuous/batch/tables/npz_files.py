"""Targets and results as NPZ: arrays by name, read and written a chunk at a time, whatever their size."""

import zipfile
from collections.abc import Callable, Iterable, Iterator
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from sinuous.batch.tables.layout import STATUSES, Block, Layout
from sinuous.batch.tables.source import Raw, Source, checked_shape
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.problem.target import KEYS


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
