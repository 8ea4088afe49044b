"""Where targets come from: rows of numbers, read a chunk at a time, from arrays or from a table with named columns."""

import zlib
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.keywords import refuse_unknown
from sinuous.model.poses import any_rotations
from sinuous.problem.target import KEYS

GROUPS = {"positions": ("x", "y", "z"), "directions": ("dx", "dy", "dz"), "rotations": ("qw", "qx", "qy", "qz")}
"""Columns of a table, by the arrays that they make."""

EXPECTED = "columns x,y,z, or dx,dy,dz, or qw,qx,qy,qz, or x,y,z with one of the others"

Raw = dict[str, Floats]
"""Rows by the names of `GoalArrays`, not checked yet: what is missing, or is no number, is NaN."""

PIECE = 1 << 24
"""Bytes of a file that are read at once."""

SHAPES: dict[str, list[tuple[int, ...]]] = {
    "positions": [(3,)],
    "directions": [(3,)],
    "rotations": [(4,), (3, 3)],
    "xyzw": [(4,)],
}
"""Shapes that a row of each array may have."""


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
            while piece := data.read(PIECE):
                crc, size = zlib.crc32(piece, crc), size + len(piece)
        return f"{size} bytes, crc {crc:08x}"

    def close(self) -> None:  # noqa: B027
        """End reading."""


def groups_of(names: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Find what a table asks by the names of its columns; others are left alone.

    Raises
    ------
    InputError
        When a column is missing, or a direction stands beside a quaternion.
    """
    found = {key: columns for key, columns in GROUPS.items() if set(columns) & set(names)}
    for columns in found.values():
        missing = [name for name in columns if name not in names]
        if missing:
            raise InputError("columns", f"there is no {', '.join(missing)}", ",".join(names), EXPECTED)
    if not found or {"directions", "rotations"} <= set(found):
        raise InputError("columns", "", ",".join(names), EXPECTED)
    twice = next((name for columns in found.values() for name in columns if list(names).count(name) > 1), None)
    if twice is not None:
        raise InputError("columns", f"{twice} is there twice", ",".join(names), EXPECTED)
    return found


class ArraySource(Source):
    """Arrays by the names of `GoalArrays`; rows with NaN are let through, to be reported."""

    def __init__(self, arrays: Mapping[str, Any]) -> None:
        refuse_unknown(arrays, KEYS)
        given = {key: value for key, value in arrays.items() if value is not None}
        turns = [key for key in given if key != "positions"]
        if not given or len(turns) > 1:
            wanted = "positions, or directions, rotations or xyzw, or positions with one of these"
            raise InputError("targets", "", list(given), wanted)
        self._raw = {key: _rows(key, value) for key, value in given.items()}
        counts = {key: len(rows) for key, rows in self._raw.items()}
        if len(set(counts.values())) > 1:
            raise InputError("targets", "", counts, "as many rows in each array")
        self.rows = next(iter(counts.values()))

    def read(self, first: int, last: int) -> Raw:
        """Return rows `first` to `last`, the end not included."""
        return {key: rows[first:last] for key, rows in self._raw.items()}

    def fingerprint(self) -> str:
        """Return a text that differs when the rows do."""
        crc = 0
        for key, rows in self._raw.items():
            crc = zlib.crc32(np.ascontiguousarray(rows).data, zlib.crc32(key.encode(), crc))
        return f"arrays of {self.rows} rows, crc {crc:08x}"


def _rows(key: str, value: Any) -> Any:
    """An array of rows; of a `Rotation` of SciPy its matrices."""
    if hasattr(value, "as_matrix"):
        value = any_rotations(value, None, key)
    try:
        rows = np.array(value, np.float64)
    except (TypeError, ValueError):
        raise InputError(key, "", value, "rows of numbers") from None
    return checked_shape(key, rows)


def checked_shape(key: str, rows: Any) -> Any:
    """Refuse an array, or what has its `shape`, that has no rows of targets."""
    shapes = SHAPES[key]
    if tuple(rows.shape[1:]) not in shapes or not rows.shape:
        wanted = " or ".join("(" + ", ".join(["m", *map(str, shape)]) + ")" for shape in shapes)
        raise InputError(key, "", f"shape {tuple(rows.shape)}", f"an array {wanted}")
    return rows
