"""A path of targets as a table: one row a waypoint, columns `x,y,z` and perhaps a direction or a quaternion.

A column `t` has the times of the waypoints. Columns are told by their names, in any order.
"""

from typing import Any, NamedTuple

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.text_tables import axis_of, read_table
from sinuous.problem.target import Target

TIME = "t"
POSITION = ("x", "y", "z")
ORIENTATIONS = {"direction": ("dx", "dy", "dz"), "rotation": ("qw", "qx", "qy", "qz")}
HEADERS = {POSITION: None} | {(*POSITION, *columns): name for name, columns in ORIENTATIONS.items()}
"""What an allowed header says beside the position."""


class PathTable(NamedTuple):
    """What a file says: targets, and their times (m,) where it has some."""

    targets: tuple[Target, ...]
    times: Floats | None


def parse_path(text: str) -> PathTable:
    """Read the targets of a table with names in its first line, and their times.

    Raises
    ------
    InputError
        With the number of the line, when the header is another one, a row has not one finite number for each column, or
        times do not increase.
    """
    table, rows = read_table(text)
    names = [axis_of(name) or name.lower() for name in table.names or ()]
    timed = TIME in names
    columns = next((each for each in HEADERS if sorted([*each, *([TIME] * timed)]) == sorted(names)), None)
    if columns is None:
        expected = " or ".join(",".join(h) for h in HEADERS) + ", perhaps with t"
        raise InputError("line 1", "", ",".join(table.names or ()) or text[:100], expected)
    if not rows:
        raise InputError("line 1", "", text, "at least one target")
    places = [names.index(name) for name in columns]
    table.warn_of_units(places, "path")
    poses, orientation = table.read_finite(rows, places), HEADERS[columns]
    turned: dict[str, Any] = {} if orientation is None else {orientation: poses[:, 3:]}
    try:
        times = checks.increasing("times", table.read_finite(rows, [names.index(TIME)])[:, 0], None) if timed else None
        return PathTable(Target.each(poses[:, :3], **turned), times)
    except InputError as error:
        if error.row is None:
            raise
        name, row = error.row
        key = f"line {rows[row][0]}.{TIME if name == 'times' else name}"
        raise InputError(key, error.problem, error.value, error.expected) from None
