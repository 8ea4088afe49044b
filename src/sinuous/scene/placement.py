"""Where the content of a file lies in the world, and how large it is there."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.arguments import Number, Orientation, Vector
from sinuous.checks import Floats
from sinuous.frozen import Frozen
from sinuous.poses import pose
from sinuous.writing.plain import pose_arguments


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
