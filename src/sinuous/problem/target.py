"""What is asked: targets, how exactly they must be met, and what is to be mapped of the workspace of a robot.

Names of segments are those of the robot.
"""

import math
import numbers
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, ClassVar, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.arguments import Number, Orientation, Orientations, Rows, Vector, Which, Whole
from sinuous.base.checks import Floats, any_segment, segment_number
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen
from sinuous.kernels.packing import read_only, target_parts, target_row, target_rows
from sinuous.kernels.tables import TARGET_SEGMENT
from sinuous.model.poses import any_rotation, any_rotations, as_pose, is_pose
from sinuous.model.robot import Robot


class GoalArrays(TypedDict, total=False):
    """Many targets of the tip as keyword arguments, instead of a list of `Target`.

    Attributes
    ----------
    positions : array_like (m, 3)
    directions : array_like (m, 3)
        Of the tangent; any length but zero.
    rotations : array_like (m, 3, 3) or (m, 4), or Rotation of SciPy
        Instead of `directions`: matrices, or quaternions wxyz.
    xyzw : array_like (m, 4)
        The same as quaternions in the order of SciPy and ROS, instead of `rotations`.
    """

    positions: Rows | None
    directions: Rows | None
    rotations: Orientations | None
    xyzw: Rows | None


KEYS = "positions", "directions", "rotations", "xyzw"
"""Their names."""


@dataclass(frozen=True, eq=False)
class TipGoals:
    """What is asked of the tip in m targets; all arrays are read-only.

    Attributes
    ----------
    positions : ndarray (m, 3) or None
    directions : ndarray (m, 3) or None
        Unit vectors.
    rotations : ndarray (m, 3, 3) or None
        There are none where there are directions.
    """

    positions: Floats | None
    directions: Floats | None
    rotations: Floats | None

    @classmethod
    def read(cls, given: Mapping[str, Any], keys: tuple[str, str, str, str] = KEYS) -> "TipGoals":
        """Check arrays; `keys` are the names of positions, directions, rotations, and quaternions xyzw.

        Raises
        ------
        InputError
            As for `Target`, with the number of the bad row, or when there is not one of each for every target.
        """
        position, direction, rotation, xyzw = (given.get(key) for key in keys)
        matrices = any_rotations(rotation, xyzw, keys[2])
        turned = keys[2] if xyzw is None else keys[3]
        if position is None and direction is None and matrices is None:
            raise InputError(keys[0], "nothing is asked of the target", None, "{}, {} or {}".format(*keys))
        if direction is not None and matrices is not None:
            raise InputError(keys[1], f"cannot be combined with {turned}", direction, f"one of {keys[1]}, {turned}")
        places = None if position is None else checks.rows(keys[0], position, 3)
        axes = None if direction is None else checks.directions(keys[1], direction)
        orientations = axes if matrices is None else matrices
        if places is not None and orientations is not None and len(places) != len(orientations):
            key = keys[1] if matrices is None else turned
            raise InputError(key, "", len(orientations), f"as many as there are positions: {len(places)}")
        return cls(places, axes, matrices)

    def __len__(self) -> int:
        return next(len(part) for part in (self.positions, self.directions, self.rotations) if part is not None)

    def __getitem__(self, index: Any) -> "TipGoals":
        """Some of them: a slice, or numbers (k,)."""
        parts = (self.positions, self.directions, self.rotations)
        return TipGoals(*(None if part is None else part[index] for part in parts))

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, part in state.items():
            if part is not None:
                part.flags.writeable = False
            object.__setattr__(self, name, part)

    @property
    def rows(self) -> Floats:
        """The targets as kernels read them, a new array (m, 15)."""
        return target_rows(len(self), self.positions, self.directions, self.rotations)

    def targets(self, i: int) -> "tuple[Target, ...]":
        """Return the one target of set `i`; this and the following are as of `ListedTargets`."""
        return Target.of_rows(self[i : i + 1].rows)

    def chunk(self, first: int, last: int) -> Floats:
        """Return some of the targets as kernels read them, a new array (last - first, 1, 15)."""
        return self[first:last].rows[:, None]

    def runs(self) -> list[tuple[int, int]]:
        """One run, of all."""
        return [(0, len(self))] if len(self) else []

    @property
    def placed(self) -> NDArray[np.bool_]:
        """Which targets have a position (m,)."""
        return np.full(len(self), self.positions is not None)

    @property
    def turned(self) -> NDArray[np.bool_]:
        """Which targets have a direction or a rotation (m,)."""
        return np.full(len(self), self.directions is not None or self.rotations is not None)


MOST_TARGETS = 1000


class TargetArguments(TypedDict, total=False):
    """Arguments of `Target`."""

    position: Vector | Rows | None
    direction: Vector | None
    rotation: Orientation | None
    segment: Which | None
    xyzw: Vector | None


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Target(Frozen):
    """What is asked of the end of one segment: a position, an orientation, or both.

    Parameters
    ----------
    position : array_like (3,) or (4, 4), optional
        Where, in the world; a pose says the rotation, too.
    direction : array_like (3,), optional
        Where the tangent of the backbone (the tool's z axis) points; any length but zero.
    rotation : array_like (3, 3) or (4,), or Rotation of SciPy, optional
        The whole orientation, instead of `direction`: a matrix or a quaternion wxyz.
    xyzw : array_like (4,), optional
        The same as a quaternion in the order of SciPy and ROS, instead of `rotation`.
    segment : int or str, optional
        The segment whose end is meant: its number, 1 = first, or its name, which becomes a number where the robot is
        known. The last one, which is the default, means the tool.

    Attributes
    ----------
    table : ndarray (1, 15)
        All this as kernels read it, read-only.

    Raises
    ------
    InputError
        When nothing is asked, or direction and rotation both, or a value is none.
    """

    position: Floats | None
    direction: Floats | None
    rotation: Floats | None
    segment: int | None
    _table: Floats

    _tables: ClassVar[frozenset[str]] = frozenset({"_table"})
    _asked: ClassVar[frozenset[str]] = frozenset({"rotation"})

    def __init__(
        self,
        position: Vector | Rows | None = None,
        *,
        direction: Vector | None = None,
        rotation: Orientation | None = None,
        segment: Which | None = None,
        xyzw: Vector | None = None,
    ) -> None:
        matrix = any_rotation(rotation, xyzw)
        if is_pose(position):
            if matrix is not None or direction is not None:
                raise InputError(
                    "position", "cannot be combined with a rotation or direction", position, "3 finite numbers"
                )
            whole = as_pose("position", position)
            position, matrix = whole[:3, 3], whole[:3, :3]
        if position is None and direction is None and matrix is None:
            raise InputError("position", "nothing is asked of the target", None, "position, direction or rotation")
        if direction is not None and matrix is not None:
            raise InputError("direction", "cannot be combined with rotation", direction, "one of direction, rotation")
        place = None if position is None else checks.vector("position", position)
        axis = None if direction is None else checks.direction("direction", direction)
        number = any_segment(segment)
        table = target_row(None if isinstance(number, str) else number, place, axis, matrix)
        self._set(position=place, direction=axis, rotation=matrix, segment=number, _table=table)

    @classmethod
    def each(
        cls,
        position: Rows | None = None,
        *,
        direction: Rows | None = None,
        rotation: Orientations | None = None,
        xyzw: Rows | None = None,
    ) -> "tuple[Target, ...]":
        """Make many targets of the tip, checked together: equal to those made one by one, in a tenth of the time.

        Parameters
        ----------
        position : array_like (m, 3), optional
        direction : array_like (m, 3), optional
        rotation : array_like (m, 3, 3) or (m, 4), or Rotation of SciPy, optional
            Instead of `direction`: matrices, or quaternions wxyz.
        xyzw : array_like (m, 4), optional
            The same as quaternions in the order of SciPy and ROS, instead of `rotation`.

        Raises
        ------
        InputError
            As for `Target`, or when there is not one of each for every target.
        """
        given = {"position": position, "direction": direction, "rotation": rotation, "xyzw": xyzw}
        return cls.of_rows(TipGoals.read(given, ("position", "direction", "rotation", "xyzw")).rows)

    @classmethod
    def of_rows(cls, rows: Floats) -> "tuple[Target, ...]":
        """Make targets of their rows (m, 15), which are kept: laid out as `sinuous.kernels.tables` says."""
        targets = []
        for i, row in enumerate(read_only(rows)):
            segment, position, direction, rotation = target_parts(row)
            target = cls.__new__(cls)
            own = {"position": position, "direction": direction, "rotation": rotation, "segment": segment}
            target.__dict__.update(own, _table=rows[i : i + 1])
            targets.append(target)
        return tuple(targets)

    def changed(self, **values: Unpack[TargetArguments]) -> "Target":
        """Return the same target with other values of some parameters."""
        return self._changed(values)

    @property
    def table(self) -> Floats:
        """All this as kernels read it (1, 15), read-only."""
        return read_only(self._table)


Targets = Target | Vector | Rows | Sequence[Target]
"""One target, or several that are to be met at once; a position (3,) or a pose (4, 4) is a target, too."""


KINDS = "a position of 3 numbers, a pose (4, 4), a Target, or a list of Targets"


def target_list(key: str, targets: Any, robot: Robot | None = None) -> tuple[Target, ...]:
    """Check one target or several that are to be met at once; for a `robot`, names of segments become numbers."""
    if is_place(targets):
        with checks.inside(key):
            targets = Target(targets)
    listed = (targets,) if isinstance(targets, Target) else targets
    if isinstance(listed, (str, bytes, dict)) or not np.iterable(listed):
        raise InputError(key, "", targets, KINDS)
    result = tuple(listed)
    if result and all(isinstance(each, numbers.Real) for each in result):
        raise InputError(key, "not 3 numbers", targets, KINDS)
    checks.integer(f"len({key})", len(result), 1, MOST_TARGETS)
    for i, target in enumerate(result):
        checks.instance(f"{key}[{i}]", target, Target, "a Target")
    return result if robot is None else _numbered(key, result, robot)


def _numbered(key: str, targets: tuple[Target, ...], robot: Robot) -> tuple[Target, ...]:
    """Give targets the numbers of the segments of this robot that they name, and refuse those of none."""
    found = list(targets)
    for i, target in enumerate(targets):
        if target.segment is not None:
            place = f"{key}.segment" if len(targets) == 1 else f"{key}[{i}].segment"
            number = segment_number(place, target.segment, robot.segment_names)
            found[i] = target if number == target.segment else target.changed(segment=number)
    return tuple(found)


def is_place(value: Any) -> bool:
    """Whether a value is a position (3,) or a pose (4, 4) of numbers."""
    if isinstance(value, (list, tuple)) and len(value) == 3:
        return all(isinstance(each, numbers.Real) for each in value)
    return (isinstance(value, np.ndarray) and value.dtype != object and value.shape == (3,)) or is_pose(value)


def target_table(robot: Robot, targets: tuple[Target, ...]) -> Floats:
    """Rows (t, 15) of all targets, for this robot; laid out as `sinuous.kernels.tables` says."""
    if len(targets) == 1 and targets[0].segment is None:  # most are: what a solve asks first
        return targets[0]._table
    return on_rows(robot, np.concatenate([target._table for target in _numbered("targets", targets, robot)]))


def on_rows(robot: Robot, table: Floats) -> Floats:
    """Return a new table (..., 15) that counts rows of a robot, of one that counts its segments."""
    table[..., TARGET_SEGMENT] += (table[..., TARGET_SEGMENT] >= 0.0) * (len(robot) - len(robot.segments))
    return table


RELATIVE_POSITION = 1e-4
ANGLE = 1e-3


@dataclass(frozen=True, init=False, repr=False)
class Tolerance(Frozen):
    """How far an answer may be from its targets, inclusive.

    Parameters
    ----------
    position : float, optional
        In the length unit; default 1e-4 of the sum of the mean segment lengths.
    angle : float
        In rad.
    """

    position: float | None
    angle: float

    def __init__(self, position: Number | None = None, angle: Number = ANGLE) -> None:
        self._set(
            position=None if position is None else checks.number("position", position, above=0.0),
            angle=checks.number("angle", angle, above=0.0),
        )

    def for_robot(self, robot: Robot) -> "Tolerance":
        """Fill in the default position tolerance."""
        return Tolerance(RELATIVE_POSITION * robot.mean_length, self.angle) if self.position is None else self


def meets(tolerance: Tolerance, off: float, turn: float) -> bool:
    """Whether errors, a length and an angle, are within a tolerance with both numbers."""
    assert tolerance.position is not None
    return off <= tolerance.position and turn <= tolerance.angle


def as_tolerance(tolerance: Tolerance | None) -> Tolerance:
    """Check tolerances; `None` stands for the defaults."""
    if tolerance is None:
        return Tolerance()
    checks.instance("tolerance", tolerance, Tolerance, "a Tolerance")
    return tolerance


MOST_DIRECTIONS = 1000

CUBE_DIRECTIONS = 26
"""Directions to the neighbours of a cube: faces, edges, corners."""


class Workspace(Frozen):
    """What a map of a workspace asks; see `reach`.

    Parameters
    ----------
    spacing : float, optional
        Edge of a voxel; by default a 35th of the robot's reach.
    directions : int or array_like (3,) or (d, 3)
        Of the tangent at the tip. 0: none, positions alone; 26: those to the neighbours of a cube; another number:
        along a spiral on a sphere; or these.
    within : float, optional
        How far the tangent may be off each direction, rad, at most pi; by default the angle of the tolerance.
    low, high : array_like (3,), optional
        Corners of what is looked at; by default all that the robot may reach. Equal entries make a slice.

    Attributes
    ----------
    axes : ndarray (d, 3)
        The directions.
    """

    spacing: float | None
    directions: int | Floats
    within: float | None
    low: Floats | None
    high: Floats | None
    axes: Floats

    def __init__(
        self,
        spacing: Number | None = None,
        directions: Whole | Vector | Rows = 0,
        within: Number | None = None,
        low: Vector | None = None,
        high: Vector | None = None,
    ) -> None:
        axes = directions_of(directions)
        if within is not None:
            if not len(axes):
                raise InputError("within", "no direction is asked for", within, "directions, too")
            if checks.number("within", within, above=0.0) > math.pi:
                raise InputError("within", "", within, "an angle up to pi, rad (20 degrees are 0.349)")
        self._set(
            spacing=None if spacing is None else checks.number("spacing", spacing, above=0.0),
            directions=int(directions) if isinstance(directions, int | np.integer) else axes,
            within=None if within is None else float(within),
            low=None if low is None else checks.vector("low", low),
            high=None if high is None else checks.vector("high", high),
            axes=axes,
        )

    @property
    def sampled(self) -> bool:
        """Whether its directions stand for all that there are."""
        return isinstance(self.directions, int) and self.directions > 1


def directions_of(value: Whole | Vector | Rows) -> Floats:
    """Directions (d, 3) on a sphere: those to the neighbours of a cube for 26, so many along a spiral, or those given.

    The spiral has points of equal area (Fibonacci lattice: Swinbank & Purser 2006).
    """
    if not isinstance(value, int | np.integer):
        listed: Any = value
        given = checks.directions("directions", [listed] if np.ndim(listed) == 1 else listed)
        if not 0 < len(given) <= MOST_DIRECTIONS:
            raise InputError("directions", "", len(given), f"1 to {MOST_DIRECTIONS} directions")
        return given
    count = checks.integer("directions", value, 0, MOST_DIRECTIONS)
    if count == CUBE_DIRECTIONS:
        steps = np.array([step for step in product((-1.0, 0.0, 1.0), repeat=3) if any(step)])
        return checks.closed(steps / np.linalg.norm(steps, axis=1, keepdims=True))
    k = np.arange(count) + 0.5
    z, turn = 1.0 - 2.0 * k / max(1, count), k * math.pi * (3.0 - math.sqrt(5.0))
    across = np.sqrt(1.0 - z * z)
    return checks.closed(np.stack([across * np.cos(turn), across * np.sin(turn), z], axis=-1))
