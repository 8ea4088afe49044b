"""Triangles as arrays: which are no triangles, where their edges meet, and what they enclose."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats

Integers = NDArray[np.int64]

FLAT = 1e-12
"""Height over longest edge, up to which a triangle counts as a line; likewise volume over the cube of the extent."""


@dataclass(frozen=True)
class Edges:
    """How triangles meet along their edges.

    Attributes
    ----------
    border : int
        Edges of one triangle only: holes.
    crowded : int
        Edges of more than two.
    clashing : int
        Edges of two triangles that turn different ways.
    """

    border: int
    crowded: int
    clashing: int

    @property
    def closed(self) -> bool:
        """Whether every edge has two triangles, which run along it in opposite directions."""
        return self.border == self.crowded == self.clashing == 0


def edges(faces: Integers) -> Edges:
    """Count the edges of `faces` (f, 3) that are not as those of a closed surface."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.minimum(start, end) * (int(faces.max()) + 1) + np.maximum(start, end)
    _, edge, count = np.unique(key, return_inverse=True, return_counts=True)
    balance = np.bincount(edge, np.where(start < end, 1.0, -1.0))
    return Edges(int((count == 1).sum()), int((count > 2).sum()), int(((count == 2) & (balance != 0.0)).sum()))


def merge_equal(vertices: Floats, faces: Integers) -> tuple[Floats, Integers]:
    """Make one vertex of all that are exactly equal: STL files repeat them for every triangle."""
    clean = vertices + 0.0  # -0 and 0 are one place
    order = np.lexsort(clean.T)
    new = np.concatenate([[True], (np.diff(clean[order], axis=0) != 0.0).any(axis=1)])
    merged = np.empty(len(vertices), np.int64)
    merged[order] = np.cumsum(new) - 1
    return clean[order[new]], merged[faces]


def drop_unused(vertices: Floats, faces: Integers) -> tuple[Floats, Integers]:
    """Keep the vertices that a triangle has, in their order."""
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    return vertices[used], (np.cumsum(used) - 1)[faces]


def are_triangles(vertices: Floats, faces: Integers) -> NDArray[np.bool_]:
    """Tell (f,) which of `faces` have an area and are no mere lines or points."""
    corners = vertices[faces]
    sides = np.roll(corners, -1, axis=1) - corners
    longest = (sides**2).sum(axis=-1).max(axis=-1)
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=-1)
    return np.asarray(area > FLAT * longest)


def volume(vertices: Floats, faces: Integers) -> float:
    """Signed volume that closed triangles enclose: positive when they turn counterclockwise as seen from outside.

    Up to rounding zero (`FLAT`) is zero.
    """
    total = float(cones(vertices, faces).sum())
    extent = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    return total if abs(total) > FLAT * extent**3 else 0.0


def cones(vertices: Floats, faces: Integers) -> Floats:
    """Signed volumes (f,) between the triangles and the middle of their box; a closed body's sum up to its own."""
    middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    a, b, c = np.moveaxis((vertices - middle)[faces], 1, 0)
    result: Floats = (a * np.cross(b, c)).sum(axis=-1) / 6.0
    return result
