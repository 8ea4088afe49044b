"""Triangles, balls and cubes, put in order as the kernels search them (see `sinuous.kernels.fields.trees`)."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.kernels.tables import BALLS, CUBES, LEAF_ITEMS, TRIANGLES
from sinuous.scene.meshes.normals import part_normals

if TYPE_CHECKING:
    from sinuous.scene.clouds.point_cloud import PointCloud
    from sinuous.scene.meshes.mesh import Mesh


@dataclass(frozen=True)
class Pieces:
    """Many primitives of one kind, in the order of their tree.

    Attributes
    ----------
    kind : int
        TRIANGLES, BALLS or CUBES of the kernels.
    levels : int
        Of the tree.
    nodes : ndarray (2 << levels, 6)
        Boxes of the tree.
    items : ndarray (m, size)
        Numbers of the primitives.
    normals : ndarray (m, 21) or (0, 21)
        Of the parts of triangles, where they have an inside.
    sign : float
        -1 where the body must stay inside.
    half : float
        Half side of cubes.
    rounding : float
        What is taken off the distance.
    """

    kind: int
    levels: int
    nodes: Floats
    items: Floats
    normals: Floats
    sign: float = 1.0
    half: float = 0.0
    rounding: float = 0.0

    @property
    def low(self) -> Floats:
        """Low corner (3,) of the box about all."""
        return self.nodes[1, :3] - self.rounding

    @property
    def high(self) -> Floats:
        """High corner (3,) of the box about all."""
        return self.nodes[1, 3:] + self.rounding


NO_NORMALS = np.empty((0, 21))


def triangles(mesh: "Mesh") -> Pieces:
    """Triangles of a mesh, with normals where it is watertight."""
    corners = mesh.vertices[mesh.faces]
    order, levels, nodes = _tree(corners.mean(axis=1), corners.min(axis=1), corners.max(axis=1))
    return Pieces(
        TRIANGLES,
        levels,
        nodes,
        with_planes(corners[order]),
        part_normals(mesh.vertices, mesh.faces)[order].reshape(-1, 21) if mesh.watertight else NO_NORMALS,
        sign=-1.0 if mesh.inside else 1.0,
        rounding=0.0 if mesh.watertight else 0.5 * mesh.thickness,
    )


def with_planes(corners: Floats) -> Floats:
    """Numbers (m, 13) of triangles: corners, unit normal, offset of the plane."""
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = sides / np.linalg.norm(sides, axis=-1, keepdims=True)
    offsets = (normals * corners[:, 0]).sum(axis=-1, keepdims=True)
    return np.concatenate([corners.reshape(-1, 9), normals, offsets], axis=1)


def balls(cloud: "PointCloud") -> Pieces:
    """Balls about the points of a cloud."""
    radii = cloud.radii[:, None]
    order, levels, nodes = _tree(cloud.points, cloud.points - radii, cloud.points + radii)
    return Pieces(BALLS, levels, nodes, np.concatenate([cloud.points, radii], axis=1)[order], NO_NORMALS)


def cubes(centers: Floats, side: float) -> Pieces:
    """Solid cubes about points (m, 3)."""
    order, levels, nodes = _tree(centers, centers - 0.5 * side, centers + 0.5 * side)
    return Pieces(CUBES, levels, nodes, centers[order], NO_NORMALS, half=0.5 * side)


def _tree(centers: Floats, lows: Floats, highs: Floats) -> tuple[NDArray[np.int64], int, Floats]:
    """Order, number of levels, and boxes (2 << levels, 6) of a tree over what has these centers and corners (m, 3)."""
    from sinuous.kernels.fields.trees import arrange, enclose  # noqa: PLC0415

    count = len(centers)
    levels = max(0, (max(1, -(-count // LEAF_ITEMS)) - 1).bit_length())
    order, nodes = np.arange(count), np.empty((2 << levels, 6))
    arrange(_plain(centers), levels, order)
    enclose(_plain(lows), _plain(highs), order, levels, nodes)
    return order, levels, nodes


def _plain(array: Floats) -> Floats:
    """Return an array as the kernels are compiled for: writable, rows one after the other."""
    return np.require(array, np.float64, ["C", "W"])
