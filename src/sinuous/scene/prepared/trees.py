"""Triangles, balls and cubes, put in order as the kernels search them (see `sinuous.kernels.fields.trees`)."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels.tables import BALLS, CUBES, LEAF_ITEMS, TRIANGLES
from sinuous.scene.meshes.mending import sides_of


def part_normals(vertices: Floats, faces: NDArray[np.int64]) -> Floats:
    """Normals of the inside, the three edges and the three corners of every triangle of a closed surface.

    At an edge the sum of the normals of its triangles; at a corner their sum weighted by their angles there (Baerentzen
    & Aanaes 2005, Signed distance computation using the angle weighted pseudonormal).

    Parameters
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray of int64 (f, 3)

    Returns
    -------
    ndarray (f, 7, 3)
        Unit vectors: triangle; edges from the first corner to the second, second to third, third to first; corners.
    """
    corners = vertices[faces]
    sides = np.roll(corners, -1, axis=1) - corners
    flat = _unit(np.cross(sides[:, 0], sides[:, 1]))
    before = -np.roll(sides, 1, axis=1)
    angles = np.arctan2(np.linalg.norm(np.cross(sides, before), axis=-1), (sides * before).sum(axis=-1))
    at_corners = _gather(faces, angles[..., None] * flat[:, None], len(vertices))
    _, edge = np.unique(sides_of(faces)[2], return_inverse=True)
    edge = edge.reshape(faces.shape)
    at_edges = _gather(edge, np.broadcast_to(flat[:, None], corners.shape), int(edge.max()) + 1)
    return np.concatenate([flat[:, None], at_edges, at_corners], axis=1)


def _gather(index: NDArray[np.int64], vectors: Floats, count: int) -> Floats:
    """Sum vectors (f, 3, 3) by their index (f, 3), and give everyone the direction of the sum of its own."""
    sums = [np.bincount(index.ravel(), vectors[..., axis].ravel(), count) for axis in range(3)]
    return _unit(np.stack(sums, axis=-1))[index]


def _unit(vectors: Floats) -> Floats:
    """Scale vectors (..., 3) to length 1; zero stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0.0, length, 1.0)


if TYPE_CHECKING:
    from sinuous.scene.meshes.mesh import Mesh
    from sinuous.scene.point_cloud import PointCloud


WORSE = 1.5
"""By how much larger leaves may be than in a new order, on average, before one is made."""


class LeafOrder(NamedTuple):
    """An order of primitives (m,), and the sum of the sides of all leaves of the tree when it was made."""

    order: NDArray[np.int64]
    leaves: float


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
    order : LeafOrder or None
        Of balls: how they were put in order.
    """

    kind: int
    levels: int
    nodes: Floats
    items: Floats
    normals: Floats
    sign: float = 1.0
    half: float = 0.0
    rounding: float = 0.0
    order: LeafOrder | None = None

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


def balls(cloud: "PointCloud", like: LeafOrder | None = None) -> Pieces:
    """Balls about the points of a cloud; in the order of as many earlier balls, if those lay in about the same way."""
    radii = cloud.radii[:, None]
    corners = cloud.points - radii, cloud.points + radii
    known = None if like is None or len(like.order) != len(cloud.points) else like
    if known is not None:
        levels, nodes = _enclosed(known.order, *corners)
        known = known if _leaves(levels, nodes) <= WORSE * known.leaves else None
    if known is None:
        order, levels, nodes = _tree(cloud.points, *corners)
        known = LeafOrder(order, _leaves(levels, nodes))
    items = np.concatenate([cloud.points, radii], axis=1)[known.order]
    return Pieces(BALLS, levels, nodes, items, NO_NORMALS, order=known)


def cubes(centers: Floats, side: float) -> Pieces:
    """Solid cubes about points (m, 3)."""
    order, levels, nodes = _tree(centers, centers - 0.5 * side, centers + 0.5 * side)
    return Pieces(CUBES, levels, nodes, centers[order], NO_NORMALS, half=0.5 * side)


def _tree(centers: Floats, lows: Floats, highs: Floats) -> tuple[NDArray[np.int64], int, Floats]:
    """Order, number of levels, and boxes (2 << levels, 6) of a tree over what has these centers and corners (m, 3)."""
    from sinuous.kernels.fields.trees import arrange  # noqa: PLC0415

    order = np.arange(len(centers))
    arrange(_plain(centers), _levels(len(centers)), order)
    return order, *_enclosed(order, lows, highs)


def _enclosed(order: NDArray[np.int64], lows: Floats, highs: Floats) -> tuple[int, Floats]:
    """Number of levels, and boxes (2 << levels, 6) of a tree over what is in this order, with these corners (m, 3)."""
    from sinuous.kernels.fields.trees import enclose  # noqa: PLC0415

    levels = _levels(len(order))
    nodes = np.empty((2 << levels, 6))
    enclose(_plain(lows), _plain(highs), order, levels, nodes)
    return levels, nodes


def _levels(count: int) -> int:
    return max(0, (max(1, -(-count // LEAF_ITEMS)) - 1).bit_length())


def _leaves(levels: int, nodes: Floats) -> float:
    """Sum of the sides of all leaves."""
    leaves = nodes[1 << levels :]
    return float((leaves[:, 3:] - leaves[:, :3]).sum())


def _plain(array: Floats) -> Floats:
    """Return an array as the kernels are compiled for: writable, rows one after the other."""
    return np.require(array, np.float64, ["C", "W"])
