"""Measurements: rows of actuator values, and where places of the body were then; and tables of them.

In a CSV file actuators are columns by their names, beside `x, y, z` of the tip; `pattern` may be there.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import ActuatorValues, HasArray, Number, Rows, Stack
from sinuous.base.checks import Floats, few, in_order
from sinuous.base.errors import InputError
from sinuous.base.text_tables import axis_of
from sinuous.base.text_tables import read_table as read_text_table
from sinuous.files.documents import read_text
from sinuous.model.robot import Robot

AXIS_LEVER = 0.1
"""Of the length of the robot: how far apart two points are that stand for the direction of an axis of a pose."""

LARGEST_SPREAD = 2.2
"""Lengths of the robot by which points of its body may be apart at most; twice, and what noise adds."""

LEAST_SPREAD = 0.02
"""Lengths of the robot: points of a body that moves are spread farther than this."""

UNIT_FACTORS = (1000.0, 0.001, 100.0, 0.01, 10.0, 0.1, 25.4, 1.0 / 25.4)
"""By what one unit of length is another."""

FOLDS = 8
"""Into how many parts rows fall, each of which is held back in turn."""

FEWEST_SEEN = 5
"""Points that must have been seen to tell which were lost."""

FAR_GAPS = 2.0
"""How many times farther than points are apart the origin is from all of them, where it stands for a lost one."""


STALLED = 0.02
"""Share of its range by which an actuator moves between two rows, where points cannot be exactly the same."""


class Place(NamedTuple):
    """A place of the body.

    Attributes
    ----------
    segment : int
        0 = first.
    share : float
        Of the length of that segment.
    offset : ndarray (3,)
        From the backbone there, in the frame of the cross-section.
    """

    segment: int
    share: float
    offset: Floats


class Measurements(NamedTuple):
    """Rows that can be used.

    Attributes
    ----------
    actuators : ndarray (N, m)
    points : ndarray (N, k, 3)
        In the frame of the measuring device, in the length unit of the robot; NaN where a point was not seen.
    places : tuple of Place (k)
    labels : tuple of str (N)
        The pattern of each row.
    folds : ndarray of int (N,)
        Which part each row belongs to; rows of a pattern belong to the same.
    rows : ndarray of int (N,)
        Their numbers among those that were given.
    dropped : tuple of int
        Numbers of the rows that hold no measurement.
    levers : ndarray (k,)
        1 where a point is one of the body, 0 where it stands for a direction.
    zeros : tuple of int
        Numbers of the rows that the device has lost: they say exactly 0, 0, 0. They count as not seen.
    """

    actuators: Floats
    points: Floats
    places: tuple[Place, ...]
    labels: tuple[str, ...]
    folds: NDArray[np.intp]
    rows: NDArray[np.intp]
    dropped: tuple[int, ...]
    levers: Floats
    zeros: tuple[int, ...] = ()

    def part(self, chosen: NDArray[np.bool_] | slice) -> "Measurements":
        """Some of the rows."""
        labels = tuple(np.array(self.labels)[chosen].tolist())
        arrays = self.actuators[chosen], self.points[chosen], self.places, labels, self.folds[chosen]
        return Measurements(*arrays, self.rows[chosen], self.dropped, self.levers, self.zeros)


def stalled(own: Measurements) -> tuple[int, ...]:
    """Numbers of rows that repeat the points of the row before exactly, although the actuators have moved."""
    moved = np.abs(np.diff(own.actuators, axis=0)) > STALLED * np.ptp(own.actuators, axis=0)
    same = (np.diff(own.points, axis=0) == 0.0).all(axis=(1, 2)) & (np.diff(own.rows) == 1) & moved.any(axis=1)
    return tuple(own.rows[1:][same].tolist())


def refuse_loose(robot: Robot) -> None:
    """Refuse a robot whose actuators do not determine its shape."""
    if not len(robot.drive):
        raise InputError("robot", "has no actuators", robot, "tendons, chambers, stages or Actuators")
    if robot.undetermined:
        problem = f"no actuator determines {few(robot.undetermined)}"
        raise InputError("robot", problem, robot, "a robot whose shape follows from its actuators")


def read(
    robot: Robot,
    actuators: ActuatorValues,
    measured: Stack,
    places: Sequence[Number] | HasArray | None,
    markers: Rows | None,
    groups: Sequence[object] | NDArray[Any] | None,
    unit: Number,
) -> Measurements:
    """Check what was measured; see `sinuous.studies.calibrate`."""
    refuse_loose(robot)
    names = [each.name for each in robot.actuators]
    ordered = in_order("actuators", actuators, names, finite=False) if isinstance(actuators, Mapping) else actuators
    values = _numbers("actuators", ordered, (None, len(names)))
    given = _numbers("measured", measured, None)
    lost = _dropouts(given)
    given[lost] = math.nan
    factor = checks.number("unit", unit, above=0.0)
    if len(given) != len(values):
        raise InputError("measured", f"{len(given)} rows", measured, f"{len(values)} rows, as many as actuators")
    points, kinds, levers = _points(robot, given, places, markers, factor)
    labels = _labels(groups, len(values))
    seen = np.isfinite(points).all(axis=2)
    good = np.asarray(np.isfinite(values).all(axis=1) & np.logical_or.reduce(seen, axis=1), np.bool_)
    points[~np.isfinite(points).all(axis=2)] = math.nan
    if not good.any():
        raise InputError("measured", "no row has finite numbers", measured, "rows of numbers")
    kept = tuple(label for label, ok in zip(labels, good, strict=True) if ok)
    dropped = tuple(int(i) for i in np.flatnonzero(~good))
    zeros = tuple(int(i) for i in np.flatnonzero(lost.reshape(len(lost), -1).any(axis=1)))
    folds, numbers = _folds(kept), np.flatnonzero(good)
    return Measurements(values[good], points[good], kinds, kept, folds, numbers, dropped, levers, zeros)


def _dropouts(given: Floats) -> NDArray[np.bool_]:
    """Tell which points (N,), (N, k) or poses (N,) are where a device puts what it has lost: exactly at its origin.

    An origin that lies among the other points, as of positions relative to a start, is a measurement.
    """
    from scipy.spatial import cKDTree  # noqa: PLC0415

    poses = given.shape[1:] == (4, 4)
    points = given[:, :3, 3] if poses else given
    lost = (points == 0.0).all(axis=-1)
    seen = points[~lost & np.isfinite(points).all(axis=-1)]
    if not lost.any() or len(seen) < FEWEST_SEEN:
        return np.zeros_like(lost)
    gaps = np.asarray(cKDTree(seen).query(seen, 2)[0])[:, 1]
    away = float(np.linalg.norm(seen, axis=1).min()) > FAR_GAPS * float(np.quantile(gaps, 0.9))
    return lost if away else np.zeros_like(lost)


def _numbers(key: str, value: Stack, shape: tuple[int | None, int] | None) -> Floats:
    """Read numbers of which some may be NaN."""
    try:
        result = np.array(value, np.float64)
    except (ValueError, TypeError):
        raise InputError(key, "", value, "rows of numbers") from None
    if shape is not None and (result.ndim != len(shape) or result.shape[1] != shape[1]):
        raise InputError(key, f"shape {result.shape}", value, f"rows of {shape[1]} numbers")
    if result.ndim not in (2, 3) or not len(result):
        raise InputError(key, f"shape {result.shape}", value, "one row a measurement: (N, 3), (N, k, 3) or (N, 4, 4)")
    return result


def _points(
    robot: Robot, given: Floats, places: Sequence[Number] | HasArray | None, markers: Rows | None, factor: float
) -> tuple[Floats, tuple[Place, ...], Floats]:
    n, before = len(robot.segments), robot.drive.before
    tip = Place(len(robot) - 1, 1.0, robot.tool[:3, 3])
    if given.ndim == 3 and given.shape[1:] == (4, 4):
        if places is not None or markers is not None:
            raise InputError("places", "poses are those of the tip", places, "no places beside poses")
        lever = AXIS_LEVER * robot.mean_length
        origin = given[:, :3, 3] * factor
        points = np.stack([origin, *(origin + lever * given[:, :3, i] for i in (0, 1))], axis=1)
        sides = [tip.offset + lever * robot.tool[:3, i] for i in (0, 1)]
        return points, (tip, *(tip._replace(offset=side) for side in sides)), np.array([1.0, 0.0, 0.0])
    points = (given[:, None] if given.ndim == 2 else given) * factor
    count = points.shape[1]
    if points.shape[2] != 3:
        raise InputError("measured", f"shape {given.shape}", given[0].tolist(), "points of 3 numbers")
    if places is None and count == 1 and not n:
        return np.array(points), (tip,), np.ones(1)
    shares = [1.0] if places is None and count == 1 else checks.array("places", places, (count,)).tolist()
    if not all(0.0 <= share <= 1.0 for share in shares):
        raise InputError("places", "", shares, "shares of the length of the body, 0 to 1")
    offsets = np.tile(robot.tool[:3, 3], (1, 1)) if places is None else np.zeros((count, 3))
    if markers is not None:
        offsets = checks.array("markers", markers, (count, 3))
    ends = np.cumsum([0.5 * sum(segment.length) for segment in robot.segments])
    kinds = []
    for share, offset in zip(shares, offsets, strict=True):
        at = share * ends[-1]
        k = min(int(np.searchsorted(ends, at)), n - 1)
        begin = ends[k - 1] if k else 0.0
        kinds.append(Place(before + k, float((at - begin) / (ends[k] - begin)) if ends[k] > begin else 1.0, offset))
    return np.array(points), tuple(kinds), np.ones(count)


def _labels(groups: Sequence[object] | NDArray[Any] | None, count: int) -> tuple[str, ...]:
    if groups is None:
        blocks = (i * FOLDS // count for i in range(count))
        return tuple(f"rows {count * i // FOLDS} to {max(0, count * (i + 1) // FOLDS - 1)}" for i in blocks)
    labels = tuple(str(label) for label in groups)
    if len(labels) != count:
        raise InputError("groups", f"{len(labels)} labels", list(labels[:3]), f"{count}, one a row")
    return labels


def _folds(labels: tuple[str, ...]) -> NDArray[np.intp]:
    """Part of each row: labels that begin alike are held back together, for they are likely of one kind of motion."""
    _, which, counts = np.unique(labels, return_inverse=True, return_counts=True)
    return ((np.cumsum(counts) - counts) * FOLDS // len(labels))[which]


def refuse_size(robot: Robot, own: Measurements) -> None:
    """Refuse measurements that are all equal, or in another unit of length than the robot."""
    points = own.points[:, own.levers > 0.0].reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    spread = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))
    length = robot.longest if robot.joints else sum(segment.length[1] for segment in robot.segments)
    moves = np.ptp(own.actuators, axis=0)
    if spread == 0.0 or not moves.any():
        key = "measured" if spread == 0.0 else "actuators"
        raise InputError(key, "all rows are equal", points[0].tolist(), "rows that differ")
    if not LEAST_SPREAD * length <= spread <= 2.0 * LARGEST_SPREAD * length:
        fits = [f for f in UNIT_FACTORS if 0.1 * length <= spread * f <= 2.0 * LARGEST_SPREAD * length]
        hint = f"; unit={fits[0]:g} would fit" if fits else ""
        problem = f"points spread over {spread:.3g}, the robot is {length:.3g} long{hint}"
        raise InputError("measured", problem, points[0].tolist(), "points in the length unit of the robot")


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
        points = _read_points([axis_of(name) or name for name in table.names])
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


def _read_points(header: list[str]) -> list[str]:
    if set(POINT) <= set(header):
        return list(POINT)
    count = 0
    while {f"{axis}{count + 1}" for axis in POINT} <= set(header):
        count += 1
    if not count:
        raise InputError("header", "no point", ",".join(header), "columns x, y, z, or x1, y1, z1, x2, ...")
    return [f"{axis}{k + 1}" for k in range(count) for axis in POINT]
