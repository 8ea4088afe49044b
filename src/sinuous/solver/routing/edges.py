"""The sharp edges of meshes, that a route may lead around, and their faces, that it may not cross."""

import math
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from sinuous.base.checks import Floats
from sinuous.scene.meshes.mending import Integers
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.snapshot import Snapshot

SHARP = math.cos(math.radians(30.0))
"""Largest cosine of the angle between the normals of both faces of a sharp edge."""

MOST = 400
"""Sharp edges of a mesh from which on it is none of walls: a route around them is not looked for."""

SMOOTH = 8
"""Triangles of a mesh for each sharp edge from which on it is smooth: what leads around it turns elsewhere, too."""

WIDTH = 10
"""Numbers of an edge, see `kernels.roadmap.places`."""


class SharpWalls(NamedTuple):
    """What is sharp-edged: edges (e, 10) that stick out, and triangles (t, 12), as `find_by_edges` takes them."""

    edges: Floats
    triangles: Floats


_NONE = SharpWalls(np.empty((0, WIDTH)), np.empty((0, 12)))
_KNOWN: "WeakKeyDictionary[Mesh, SharpWalls]" = WeakKeyDictionary()


def walls_of(scene: Snapshot) -> SharpWalls:
    """Return the walls of all solid meshes that are not smooth."""
    found = [walls for walls in _all(scene) if len(walls.triangles) < SMOOTH * len(walls.edges)]
    return SharpWalls(*map(np.concatenate, zip(*found, strict=True))) if found else _NONE


def rims_of(scene: Snapshot) -> Floats:
    """Return the sharp edges (e, 10) of all solid meshes, also of smooth ones: mouths of tubes may lie beside them."""
    return np.concatenate([_NONE.edges, *(walls.edges for walls in _all(scene))])


def _all(scene: Snapshot) -> list[SharpWalls]:
    return [_of(mesh) for mesh in scene.obstacles if isinstance(mesh, Mesh) and mesh.watertight and not mesh.inside]


def _of(mesh: Mesh) -> SharpWalls:
    walls = _KNOWN.get(mesh)
    if walls is None:
        edges = _sticking_out(mesh.vertices, mesh.faces)
        walls = _KNOWN[mesh] = SharpWalls(edges, _faces(mesh)) if 0 < len(edges) <= MOST else _NONE
    return walls


def _faces(mesh: Mesh) -> Floats:
    """Triangles (t, 12), as `kernels.roadmap.sight` reads them."""
    corners = mesh.vertices[mesh.faces]
    corners[:, 1:] -= corners[:, :1]
    return np.hstack([corners.reshape(-1, 9), np.cross(corners[:, 1], corners[:, 2])])


def _sticking_out(vertices: Floats, faces: Integers) -> Floats:
    """Edges (e, 10) between two faces that make a convex angle."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort(ends.T)
    ends, owner = ends[order], order // 3
    opposite = faces[:, [2, 0, 1]].reshape(-1)[order]
    pairs = ends.reshape(-1, 2, 2)[:, 0]  # watertight: every edge has two faces
    one, other = owner.reshape(-1, 2).T
    start, end = vertices[pairs[:, 0]], vertices[pairs[:, 1]]
    cosine = (normals[one] * normals[other]).sum(axis=1)
    below = ((vertices[opposite.reshape(-1, 2)[:, 1]] - start) * normals[one]).sum(axis=1)
    kept = np.flatnonzero((cosine < SHARP) & (below < 0.0) & (cosine > -0.9))
    way = (normals[one] + normals[other])[kept] / (1.0 + cosine[kept, None])
    line = (end - start)[kept]
    length = np.linalg.norm(line, axis=1, keepdims=True)
    return np.hstack([0.5 * (start + end)[kept], way, line / length, 0.5 * length])
