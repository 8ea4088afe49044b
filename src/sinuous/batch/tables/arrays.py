"""Targets that are in memory already."""

import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from sinuous.batch.tables.source import Raw
from sinuous.errors import InputError
from sinuous.poses import any_rotations
from sinuous.problem.target import KEYS

SHAPES: dict[str, list[tuple[int, ...]]] = {
    "positions": [(3,)],
    "directions": [(3,)],
    "rotations": [(4,), (3, 3)],
    "xyzw": [(4,)],
}
"""What a row of each array may be."""


class ArraySource:
    """Arrays by the names of `GoalArrays`; rows with NaN are let through, to be reported."""

    def __init__(self, arrays: Mapping[str, Any]) -> None:
        unknown = next((key for key in arrays if key not in KEYS), None)
        if unknown is not None:
            raise InputError(unknown, "is not known", arrays[unknown], "one of " + ", ".join(KEYS))
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

    def close(self) -> None:
        """Nothing is open."""


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
