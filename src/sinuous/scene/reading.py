"""What readers of geometry have in common: files, where their content lies in the world, what is remembered of them."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Orientation, Vector
from sinuous.base.checks import Floats
from sinuous.base.documents import plain, pose_arguments, readable
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen
from sinuous.model.poses import pose


def check_file(file: Path, kinds: Sequence[str]) -> None:
    """Refuse a file that is not there or cannot be read, or whose name does not end in one of `kinds`."""
    if file.suffix.lower() not in kinds:
        raise InputError("file", "", str(file), "a name that ends in " + ", ".join(kinds))
    with readable(file), file.open("rb"):
        pass


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Placement(Frozen):
    """The map p -> rotation * scale * p + position from a file to the world.

    Parameters
    ----------
    scale : float
        Greater than 0.
    position : array_like (3,), optional
    rotation : array_like (3, 3) or (4,), or Rotation of SciPy, optional
        A matrix or a quaternion wxyz.
    xyzw : array_like (4,), optional
        A quaternion in the order of SciPy and ROS, instead of `rotation`.
    """

    scale: float
    pose: Floats

    def __init__(
        self,
        scale: Number,
        position: Vector | None = None,
        rotation: Orientation | None = None,
        xyzw: Vector | None = None,
    ) -> None:
        self._set(scale=checks.number("scale", scale, above=0.0), pose=pose(position, rotation=rotation, xyzw=xyzw))

    @property
    def arguments(self) -> dict[str, Any]:
        """What makes an equal placement."""
        return {"scale": self.scale, **(pose_arguments(self.pose) or {})}

    def apply(self, points: Floats) -> Floats:
        """Map points (m, 3); what is not finite stays so."""
        with np.errstate(invalid="ignore", over="ignore"):
            moved: Floats = (self.scale * points) @ self.pose[:3, :3].T + self.pose[:3, 3]
        return moved


class Origin(NamedTuple):
    """Where an obstacle was read from.

    Attributes
    ----------
    file : Path
        Absolute.
    arguments : dict
        How it was read, in plain values: the keys that stand beside the file in a problem file.
    parts : int
        Into how many obstacles, one after the other in their scene, it was divided.
    """

    file: Path
    arguments: dict[str, Any]
    parts: int = 1

    @classmethod
    def of(cls, file: str | Path, **arguments: Any) -> "Origin":
        """Remember a file and how it was read; what says nothing is left out."""
        written = {key: plain(value) for key, value in arguments.items()}
        return cls(Path(file).absolute(), {key: value for key, value in written.items() if value is not None})

    def entry(self, folder: Path) -> dict[str, Any]:
        """Return what a problem file in this folder says."""
        try:
            name = Path(os.path.relpath(self.file, folder.absolute())).as_posix()
        except ValueError:  # on another drive
            name = str(self.file)
        return {"file": name, **self.arguments}
