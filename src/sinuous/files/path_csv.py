"""A path of targets as a table: one row a waypoint, columns `x,y,z` and perhaps a direction or a quaternion.

A column `t` in front of these has the times of the waypoints.
"""

import csv
import io
import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.files.documents import NUMBER
from sinuous.problem.target import Target

TIME = "t"
POSITION = ("x", "y", "z")
ORIENTATIONS = {
    "direction": ("dx", "dy", "dz"),
    "rotation": ("qw", "qx", "qy", "qz"),
    "xyzw": ("qx", "qy", "qz", "qw"),
}
HEADERS = {POSITION: None} | {(*POSITION, *columns): name for name, columns in ORIENTATIONS.items()}
"""What an allowed header says beside the position."""


class PathTable(NamedTuple):
    """What a file says: targets, and their times (m,) where it has some."""

    targets: tuple[Target, ...]
    times: Floats | None


def parse_path(text: str) -> PathTable:
    """Read the targets of a CSV file with a header, and their times.

    Raises
    ------
    InputError
        With the number of the line, when the header is another one, a row has not one finite number for each column, or
        times do not increase.
    """
    (line, names), *rows = list(_rows(text)) or [(1, [])]
    header = tuple(name.strip() for name in names)
    timed = header[:1] == (TIME,)
    if header[timed:] not in HEADERS:
        expected = " or ".join(",".join(h) for h in HEADERS) + ", perhaps with t in front"
        raise InputError(f"line {line}", "", ",".join(names), expected)
    if not rows:
        raise InputError(f"line {line}", "", text, "at least one target")
    numbers = _numbers(header, rows)
    orientation, poses = HEADERS[header[timed:]], numbers[:, timed:]
    turned: dict[str, Any] = {} if orientation is None else {orientation: poses[:, 3:]}
    try:
        times = checks.increasing("times", numbers[:, 0], None) if timed else None
        return PathTable(Target.each(poses[:, :3], **turned), times)
    except InputError as error:
        if error.row is None:
            raise
        name, row = error.row
        key = f"line {rows[row][0]}.{TIME if name == 'times' else name}"
        raise InputError(key, error.problem, error.value, error.expected) from None


def _rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number of the line and the cells of every row that is not empty."""
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells):
                yield reader.line_num, cells
    except csv.Error as error:
        raise InputError(f"line {reader.line_num}", str(error), text, "comma-separated values") from None


def _numbers(header: tuple[str, ...], rows: list[tuple[int, list[str]]]) -> Floats:
    """Numbers (m, k) of all rows; a refusal names the line."""
    numbers = []
    for line, cells in rows:
        with checks.inside(f"line {line}"):
            if len(cells) != len(header):
                raise InputError("", "wrong number of cells", cells, f"{len(header)}: {','.join(header)}")
            numbers.append([_number(name, cell.strip()) for name, cell in zip(header, cells, strict=True)])
    return np.array(numbers)


def _number(name: str, cell: str) -> float:
    if not NUMBER.fullmatch(cell):
        raise InputError(name, "", cell, "a finite number")
    value = float(cell)
    return value if math.isfinite(value) else checks.number(name, value)
