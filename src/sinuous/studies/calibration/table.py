"""Measurements in a CSV file: a column an actuator, by its name, and `x, y, z` of the tip; `pattern` may be there."""

from pathlib import Path
from typing import NamedTuple

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.text_tables import axis_of
from sinuous.base.text_tables import read_table as read_text_table
from sinuous.files.documents import read_text

POINT = ("x", "y", "z")

PATTERN = "pattern"


class Measured(NamedTuple):
    """A table: actuators (N, m), points (N, 3) or (N, k, 3), and the pattern of each row where the table says it."""

    actuators: Floats
    measured: Floats
    groups: tuple[str, ...] | None


def read_table(file: Path, names: list[str]) -> Measured:
    """Read a table of measurements.

    Its header has the name of every actuator, then `x, y, z`; several points are `x1, y1, z1, x2, ...`. Empty cells and
    `nan` were not measured. Other columns are left alone. Separators, decimal commas
    and the order of columns are told as `base.text_tables` says.

    Raises
    ------
    InputError
        When a column is missing, or a cell holds no number.
    """
    with checks.in_file(file):
        table, rows = read_text_table(read_text(file))
        if not rows or table.names is None:
            raise InputError("", "no rows", None, "a header and one row a measurement")
        points = _points([axis_of(name) or name for name in table.names])
        missing = [name for name in names if name not in table.names]
        if missing:
            wanted = "a column for every actuator: " + ", ".join(names)
            raise InputError("header", f"no column {missing[0]}", list(table.names), wanted)
        places = [place for name in (*names, *points) if (place := table.place(name)) is not None]
        numbers = table.read(rows, places)
        measured = numbers[:, len(names) :].reshape(len(numbers), -1, 3)
        at = table.place(PATTERN)
        groups = None if at is None else tuple(table.cells(line)[at] for _, line in rows)
    return Measured(numbers[:, : len(names)], measured[:, 0] if measured.shape[1] == 1 else measured, groups)


def _points(header: list[str]) -> list[str]:
    if set(POINT) <= set(header):
        return list(POINT)
    count = 0
    while {f"{axis}{count + 1}" for axis in POINT} <= set(header):
        count += 1
    if not count:
        raise InputError("header", "no point", ",".join(header), "columns x, y, z, or x1, y1, z1, x2, ...")
    return [f"{axis}{k + 1}" for k in range(count) for axis in POINT]
