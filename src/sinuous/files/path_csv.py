"""A path of targets as a table: one row a waypoint, columns `x,y,z` and perhaps a direction or a quaternion.

A column `t` in front of these has the times of the waypoints.
"""

import csv
import io
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
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


class Table(NamedTuple):
    """What a file says: targets, and their times (m,) where it has some."""

    targets: tuple[Target, ...]
    times: Floats | None


def parse_path(text: str) -> Table:
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
    times = _times(rows) if timed else None
    poses = [(number, cells[timed:]) for number, cells in rows]
    own = header[timed:]
    return Table(_together(own, [cells for _, cells in poses]) or tuple(_one_by_one(own, poses)), times)


def _times(rows: list[tuple[int, list[str]]]) -> Floats:
    """Take the first cells of all rows, which must increase."""
    times: list[float] = []
    for line, cells in rows:
        with checks.inside(f"line {line}"):
            time = _number(TIME, cells[0].strip())
            if times and time <= times[-1]:
                raise InputError(TIME, "times must increase", time, f"more than {times[-1]:g}")
            times.append(time)
    return np.array(times)


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
