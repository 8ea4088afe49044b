"""Obstacles made of points: what a scanner or a depth camera sees."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.arguments import Number, Orientation, Rows, Vector
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.reading import Placement, Source


@dataclass(frozen=True, init=False, eq=False, repr=False)
class PointCloud(Obstacle):
    """The union of balls about points.

    Parameters
    ----------
    points : array_like (m, 3)
        In the world; at least one.
    radius : float or array_like (m,)
        Of the balls, at least 0: one for all, or one for each point. Half the spacing of a scan closes its gaps.
    name : str, optional

    Attributes
    ----------
    points : ndarray (m, 3)
    radii : ndarray (m,)

    Raises
    ------
    InputError
        When there is no point, or something is not finite, negative, or of the wrong shape.
    """

    radii: Floats

    def __init__(self, points: Rows, radius: Number | Vector, *, name: str | None = None) -> None:
        places = checks.points("points", points)
        self._keep(name, _points=places, radii=_radii(radius, len(places)))

    @property
    def points(self) -> Floats:
        """Centers (m, 3) of the balls, in the world."""
        own: Floats = vars(self)["_points"]
        return self._in_place(own)

    @property
    def kind(self) -> str:
        """See `Obstacle.kind`."""
        return "points"

    def _content(self) -> dict[str, Any]:
        return {**super()._content(), "points": self.points}

    @property
    def radius(self) -> float | Floats:
        """One radius where all balls have the same, or all of them (m,)."""
        return self.radii if (self.radii != self.radii[0]).any() else float(self.radii[0])

    @classmethod
    def load(
        cls,
        file: str | Path,
        radius: Number | Vector,
        scale: Number = 1.0,
        position: Vector | None = None,
        rotation: Orientation | None = None,
        name: str | None = None,
        *,
        xyzw: Vector | None = None,
    ) -> "PointCloud":
        """Read a cloud from a PLY (needs the extra `mesh`), PCD, NPY, XYZ, TXT or CSV file.

        A point p of the file comes to lie at `rotation @ (scale * p) + position`. A text has one point a line, three
        numbers or more between commas or spaces, of which the first three count; `#` starts a comment, and the first
        line may hold names. An NPY file has an array (m, 3).

        Parameters
        ----------
        file : path
        radius : float or array_like (m,)
            In the unit of the scene.
        scale : float
            Length unit of the scene over that of the file.
        position : array_like (3,), optional
            Where the origin of the file lies.
        rotation : array_like (3, 3) or (4,), or Rotation of SciPy, optional
            A matrix or a quaternion wxyz.
        name : str, optional
        xyzw : array_like (4,), optional
            A quaternion in the order of SciPy and ROS, instead of `rotation`.

        Raises
        ------
        InputError
            When the file cannot be read or holds no points, or as `PointCloud` does.
        """
        from sinuous.scene.cloud_files import read_points  # noqa: PLC0415

        placement = Placement(scale, position, rotation, xyzw)
        try:
            points = checks.points("points", placement.apply(checks.points("points", read_points(Path(file)))))
        except InputError as error:
            raise error if error.key == "file" else error.in_file(file) from None
        cloud = cls(points, radius, name=name)
        cloud._set(_source=Source.of(file, **placement.arguments, radius=cloud.radius))
        return cloud


def _radii(radius: Any, count: int) -> Floats:
    """Check one radius for all, or one for each of `count` points; return all of them, read-only."""
    if np.ndim(radius) == 0 or isinstance(radius, str):
        return checks.closed(np.full(count, checks.number("radius", radius, low=0.0)))
    radii = checks.array("radius", radius, (count,))
    if (radii < 0.0).any():
        first = int(radii.argmin())
        raise InputError(f"radius[{first}]", "", float(radii[first]), "a number of at least 0")
    return radii
