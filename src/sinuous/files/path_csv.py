"""A path of targets as a table: one row a waypoint, columns `x,y,z` and perhaps a direction or a quaternion."""

import csv
import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.errors import InputError
from sinuous.files.text import NUMBER
from sinuous.problem.target import Target

POSITION = ("x", "y", "z")
ORIENTATIONS = {
    "direction": ("dx", "dy", "dz"),
    "rotation": ("qw", "qx", "qy", "qz"),
    "xyzw": ("qx", "qy", "qz", "qw"),
}
HEADERS = {POSITION: None} | {(*POSITION, *columns): name for name, columns in ORIENTATIONS.items()}
"""What an allowed header says beside the position."""


def parse_path(text: str) -> tuple[Target, ...]:
    """Read the targets of a CSV file with a header.

    Raises
    ------
    InputError
        With the number of the line, when the header is another one, or a row has not one finite number for each column.
    """
    (line, names), *rows = list(_rows(text)) or [(1, [])]
    header = tuple(name.strip() for name in names)
    if header not in HEADERS:
        raise InputError(f"line {line}", "", ",".join(names), " or ".join(",".join(h) for h in HEADERS))
    if not rows:
        raise InputError(f"line {line}", "", text, "at least one target")
    return _together(header, [cells for _, cells in rows]) or tuple(_one_by_one(header, rows))


def _rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number of the line and the cells of every row that is not empty."""
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells):
                yield reader.line_num, cells
    except csv.Error as error:
        raise InputError(f"line {reader.line_num}", str(error), text, "comma-separated values") from None


def _together(header: tuple[str, ...], rows: list[list[str]]) -> tuple[Target, ...]:
    """Targets of all rows; none where something is wrong with one."""
    if set(map(len, rows)) != {len(header)}:
        return ()
    cells = [cell.strip() for row in rows for cell in row]
    if not all(map(NUMBER.fullmatch, cells)):
        return ()
    values = np.array(list(map(float, cells))).reshape(len(rows), -1)
    orientation = HEADERS[header]
    try:
        return Target.each(values[:, :3], **({} if orientation is None else {orientation: values[:, 3:]}))
    except InputError:
        return ()


def _one_by_one(header: tuple[str, ...], rows: list[tuple[int, list[str]]]) -> Iterator[Target]:
    """Yield the targets; a refusal names the line."""
    for line, cells in rows:
        with checks.inside(f"line {line}"):
            yield _target(header, cells)


def _target(header: tuple[str, ...], cells: list[str]) -> Target:
    if len(cells) != len(header):
        raise InputError("", "wrong number of cells", cells, f"{len(header)}: {','.join(header)}")
    values = [_number(name, cell.strip()) for name, cell in zip(header, cells, strict=True)]
    orientation = HEADERS[header]
    own: dict[str, Any] = {} if orientation is None else {orientation: values[3:]}
    return Target(values[:3], **own)


def _number(name: str, cell: str) -> float:
    if not NUMBER.fullmatch(cell):
        raise InputError(name, "", cell, "a finite number")
    return checks.number(name, float(cell))
