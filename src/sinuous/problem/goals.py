"""Where the tip must be and how it must point, many times: arrays, checked together."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypedDict

from sinuous import checks
from sinuous.arguments import Orientations, Rows
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.packing import target_rows
from sinuous.poses import any_rotations


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
class Goals:
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
    def read(cls, given: Mapping[str, Any], keys: tuple[str, str, str, str] = KEYS) -> "Goals":
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
            raise InputError(keys[1], f"stands beside {turned}", direction, f"one of {keys[1]}, {turned}")
        places = None if position is None else checks.rows(keys[0], position, 3)
        axes = None if direction is None else checks.directions(keys[1], direction)
        orientations = axes if matrices is None else matrices
        if places is not None and orientations is not None and len(places) != len(orientations):
            key = keys[1] if matrices is None else turned
            raise InputError(key, "", len(orientations), f"as many as there are positions: {len(places)}")
        return cls(places, axes, matrices)

    def __len__(self) -> int:
        return next(len(part) for part in (self.positions, self.directions, self.rotations) if part is not None)

    def __getitem__(self, index: Any) -> "Goals":
        """Some of them: a slice, or numbers (k,)."""
        parts = (self.positions, self.directions, self.rotations)
        return Goals(*(None if part is None else part[index] for part in parts))

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, part in state.items():
            if part is not None:
                part.flags.writeable = False
            object.__setattr__(self, name, part)

    @property
    def rows(self) -> Floats:
        """The targets as kernels read them, a new array (m, 15)."""
        return target_rows(len(self), self.positions, self.directions, self.rotations)
