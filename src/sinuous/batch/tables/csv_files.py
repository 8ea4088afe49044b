"""Targets and results as CSV: readable everywhere, and ten times as slow as the others."""

import csv
import warnings
from collections.abc import Iterable, Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from sinuous.batch.tables.layout import Block, Layout
from sinuous.batch.tables.source import Raw, Source, groups_of
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.files.text import NUMBER


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
