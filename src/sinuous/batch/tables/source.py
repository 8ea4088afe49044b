"""Where targets come from: rows of numbers, read a chunk at a time, and what their columns are called."""

import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from sinuous.checks import Floats
from sinuous.errors import InputError

GROUPS = {"positions": ("x", "y", "z"), "directions": ("dx", "dy", "dz"), "rotations": ("qw", "qx", "qy", "qz")}
"""Columns of a table, by the arrays that they make."""

EXPECTED = "columns x,y,z, or dx,dy,dz, or qw,qx,qy,qz, or x,y,z with one of the others"

Raw = dict[str, Floats]
"""Rows by the names of `GoalArrays`, not checked yet: what is missing, or is no number, is NaN."""

PIECE = 1 << 24


class Source(Protocol):
    """Targets in rows."""

    rows: int

    def read(self, first: int, last: int) -> Raw:
        """Return rows `first` to `last`, the end not included; chunks are asked for in rising order."""
        ...

    def fingerprint(self) -> str:
        """Return a text that differs when the rows do."""
        ...

    def close(self) -> None:
        """End reading."""
        ...


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


def fingerprint_of(file: Path) -> str:
    """Size and checksum of a file: they differ when somebody changed it."""
    crc = size = 0
    with file.open("rb") as data:
        while piece := data.read(PIECE):
            crc, size = zlib.crc32(piece, crc), size + len(piece)
    return f"{size} bytes, crc {crc:08x}"
