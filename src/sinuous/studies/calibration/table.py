"""Measurements in a CSV file: a column an actuator, by its name, and `x, y, z` of the tip; `pattern` may be there."""

import csv
import io
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
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
    `nan` were not measured. Other columns are left alone.

    Raises
    ------
    InputError
        When a column is missing, or a cell holds no number.
    """
    with checks.in_file(file):
        text = read_text(file)
        rows = [row for row in csv.reader(line for line in io.StringIO(text) if not line.startswith("#")) if row]
        if len(rows) < 2:
            raise InputError("", "no rows", None, "a header and one row a measurement")
        header = [cell.strip() for cell in rows[0]]
        points = _points(header)
        missing = [name for name in names if name not in header]
        if missing:
            raise InputError(
                "header", f"no column {missing[0]}", header, "a column for every actuator: " + ", ".join(names)
            )
        wanted = [*names, *points]
        table = np.array(
            [[_number(row, header.index(name), i, name) for name in wanted] for i, row in enumerate(rows[1:])]
        )
        values, places = table[:, : len(names)], table[:, len(names) :].reshape(len(table), -1, 3)
        at = header.index(PATTERN) if PATTERN in header else None
        groups = None if at is None else tuple(row[at] for row in rows[1:])
    return Measured(values, places[:, 0] if places.shape[1] == 1 else places, groups)


def _points(header: list[str]) -> list[str]:
    if set(POINT) <= set(header):
        return list(POINT)
    count = 0
    while {f"{axis}{count + 1}" for axis in POINT} <= set(header):
        count += 1
    if not count:
        raise InputError("header", "no point", ",".join(header), "columns x, y, z, or x1, y1, z1, x2, ...")
    return [f"{axis}{k + 1}" for k in range(count) for axis in POINT]


def _number(row: list[str], at: int, line: int, name: str) -> float:
    cell = row[at].strip() if at < len(row) else ""
    if not cell:
        return math.nan
    try:
        return float(cell)
    except ValueError:
        raise InputError(f"row {line}", f"column {name}", cell, "a number, or nothing") from None
