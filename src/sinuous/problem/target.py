"""Where the tip, or the end of any segment, must be."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import Any, ClassVar, TypedDict, Unpack

import numpy as np

from sinuous import checks
from sinuous.arguments import Orientation, Orientations, Rows, Vector, Whole
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.frozen import Frozen
from sinuous.packing import read_only, target_row
from sinuous.poses import any_rotation
from sinuous.problem.goals import Goals
from sinuous.robot.robot import MOST_SEGMENTS, Robot

MOST_TARGETS = 1000


class TargetArguments(TypedDict, total=False):
    """Arguments of `Target`."""

    position: Vector | None
    direction: Vector | None
    rotation: Orientation | None
    segment: Whole | None
    xyzw: Vector | None


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Target(Frozen):
    """What is asked of the end of one segment: a position, an orientation, or both.

    Parameters
    ----------
    position : array_like (3,), optional
        Where, in the world.
    direction : array_like (3,), optional
        Where the tangent of the backbone (the tool's z axis) points; any length but zero.
    rotation : array_like (3, 3) or (4,), or Rotation of SciPy, optional
        The whole orientation, instead of `direction`: a matrix or a quaternion wxyz.
    xyzw : array_like (4,), optional
        The same as a quaternion in the order of SciPy and ROS, instead of `rotation`.
    segment : int, optional
        The segment whose end is meant, 1 = first. The last one, which is the default, means the tool.

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

    def __init__(
        self,
        position: Vector | None = None,
        *,
        direction: Vector | None = None,
        rotation: Orientation | None = None,
        segment: Whole | None = None,
        xyzw: Vector | None = None,
    ) -> None:
        matrix = any_rotation(rotation, xyzw)
        if position is None and direction is None and matrix is None:
            raise InputError("position", "nothing is asked of the target", None, "position, direction or rotation")
        if direction is not None and matrix is not None:
            raise InputError("direction", "stands beside rotation", direction, "one of direction, rotation")
        place = None if position is None else checks.vector("position", position)
        axis = None if direction is None else checks.direction("direction", direction)
        number = None if segment is None else checks.integer("segment", segment, 1, MOST_SEGMENTS)
        table = target_row(number, place, axis, matrix)
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
        return cls.of_goals(Goals.read(given, ("position", "direction", "rotation", "xyzw")))

    @classmethod
    def of_goals(cls, goals: Goals) -> "tuple[Target, ...]":
        """Make targets of arrays that were checked."""
        parts = [
            repeat(None) if part is None else part for part in (goals.positions, goals.directions, goals.rotations)
        ]
        targets = []
        for row, place, axis, matrix in zip(goals.rows[:, None], *parts, strict=False):
            target = cls.__new__(cls)
            target.__dict__.update(position=place, direction=axis, rotation=matrix, segment=None, _table=row)
            targets.append(target)
        return tuple(targets)

    def changed(self, **values: Unpack[TargetArguments]) -> "Target":
        """Return the same target with other values of some parameters."""
        own: dict[str, Any] = {key: getattr(self, key) for key in ("position", "direction", "rotation", "segment")}
        return Target(**{**own, **values})

    @property
    def table(self) -> Floats:
        """All this as kernels read it (1, 15), read-only."""
        table: Floats = read_only(self._table)
        return table


Targets = Target | Sequence[Target]


def target_list(key: str, targets: Any) -> tuple[Target, ...]:
    """Check one target or several that are to be met at once."""
    listed = (targets,) if isinstance(targets, Target) else targets
    if isinstance(listed, (str, bytes, dict)) or not np.iterable(listed):
        raise InputError(key, "", targets, "a Target or a list of them")
    result = tuple(listed)
    checks.integer(f"len({key})", len(result), 1, MOST_TARGETS)
    for i, target in enumerate(result):
        if not isinstance(target, Target):
            raise InputError(f"{key}[{i}]", "", target, "a Target")
    return result


def target_table(robot: Robot, targets: tuple[Target, ...]) -> Floats:
    """Rows (t, 15) of all targets, for this robot; laid out as `sinuous.kernels.tables` says."""
    for i, target in enumerate(targets):
        if target.segment is not None and target.segment > len(robot):
            raise InputError(f"targets[{i}].segment", "", target.segment, f"a segment from 1 to {len(robot)}")
    if len(targets) == 1:
        return targets[0]._table
    return np.concatenate([target._table for target in targets])
