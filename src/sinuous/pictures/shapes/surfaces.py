"""Surfaces of obstacles as facets."""

import math

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.pictures.shapes.facets import cut, lathe, of_grid, turned
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Primitive, Sphere

AROUND = 32
"""Facets around a round obstacle."""

ALONG = 12
"""Facets from pole to pole, along a wall, or along an edge."""

MOST_TRIANGLES = 12_000
"""Triangles of a mesh that are drawn; of more, vertices that fall together on a grid become one."""

FINEST, COARSEST = 96, 12
"""Cells of that grid along the longest side of the mesh."""


def obstacle_surface(
    obstacle: Obstacle, middle: Floats, span: float, around: int = AROUND, edge: int = ALONG
) -> Floats:
    """Facets (m, 4, 3) of an exact obstacle or a mesh; of a half-space a square with sides of `span` near `middle`.

    `around` and `edge` say how many there are around what is round, and along the edge of a box. They face the side
    where the body may be; a shell, which has no inside, faces both ways.
    """
    if isinstance(obstacle, Mesh):
        return of_mesh(obstacle)
    if isinstance(obstacle, HalfSpace):
        near = middle - (middle - obstacle.point) @ obstacle.normal * obstacle.normal
        return near + _square(0.5 * span, edge) @ obstacle.frame.rotation.T
    if not isinstance(obstacle, Primitive):
        raise NotImplementedError(f"no picture of {type(obstacle).__name__}")
    center, rotation, half = obstacle.frame
    local = _box(half, edge) if isinstance(obstacle, Box) else lathe(_profile(obstacle, float(half[2])), around)
    surface: Floats = center + local @ rotation.T
    return turned(surface) if getattr(obstacle, "inside", False) else surface


def of_mesh(mesh: Mesh) -> Floats:
    """Triangles as facets, none of them long: a picture sorts them by their middles."""
    vertices, faces = (mesh.vertices, mesh.faces) if len(mesh.faces) <= MOST_TRIANGLES else _thinned(mesh)
    corners = cut(vertices[faces[:, [0, 1, 2, 2]]], 0.1 * float(np.ptp(vertices, axis=0).max()))
    inside = corners[:, [2, 1, 0, 0]]
    if not mesh.watertight:
        return np.concatenate([corners, inside])
    return inside if mesh.inside else corners


def _thinned(mesh: Mesh) -> tuple[Floats, NDArray[np.int64]]:
    """Vertices and faces of a mesh, so many that a picture can have them."""
    cells = FINEST
    vertices, faces = _clustered(mesh, cells)
    while len(faces) > MOST_TRIANGLES and cells > COARSEST:
        cells = 3 * cells // 4
        vertices, faces = _clustered(mesh, cells)
    return vertices, faces


def _clustered(mesh: Mesh, cells: int) -> tuple[Floats, NDArray[np.int64]]:
    """Vertices and faces where all vertices in a cell of a grid have become their mean."""
    low, edge = mesh.vertices.min(axis=0), np.ptp(mesh.vertices, axis=0).max() / cells
    places = np.floor((mesh.vertices - low) / edge).astype(np.int64)
    _, group, count = np.unique(places, axis=0, return_inverse=True, return_counts=True)
    group = group.ravel()
    sums = np.zeros((len(count), 3))
    np.add.at(sums, group, mesh.vertices)
    faces = group[mesh.faces]
    a, b, c = faces.T
    return sums / count[:, None], faces[(a != b) & (b != c) & (c != a)]


def _profile(obstacle: Obstacle, half: float) -> Floats:
    """Outline (p, 2) of a body of revolution from pole to pole: distance from its axis, and place along it."""
    if isinstance(obstacle, Cylinder):
        wall = np.linspace(-half, half, ALONG + 1)
        corners = [[0.0, -half], *([obstacle.radius, z] for z in wall), [0.0, half]]
        return np.array(corners)
    if not isinstance(obstacle, Sphere | Capsule):
        raise NotImplementedError(f"no picture of {type(obstacle).__name__}")
    if half == 0.0:
        return _arc(obstacle.radius, -0.5 * math.pi, 0.5 * math.pi, 2 * (ALONG // 2) + 2)
    shift = np.array([0.0, half])
    low = _arc(obstacle.radius, -0.5 * math.pi, 0.0, ALONG // 2 + 1) - shift
    high = _arc(obstacle.radius, 0.0, 0.5 * math.pi, ALONG // 2 + 1) + shift
    return np.concatenate([low, np.linspace(low[-1], high[0], ALONG + 1)[1:-1], high])


def _arc(radius: float, begin: float, end: float, count: int) -> Floats:
    angles = np.linspace(begin, end, count)
    points: Floats = radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return points


def _box(half: Floats, count: int) -> Floats:
    """Six faces; each is cut into squares, because a picture sorts facets by the distance of their middles."""
    faces = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            face = _square(1.0, count)
            face[..., 2] = side
            faces.append(np.roll(face[:, :: int(side)], axis + 1, axis=-1) * half)
    return np.concatenate(faces)


def _square(half: float, count: int) -> Floats:
    edge = np.linspace(-half, half, count + 1)
    x, y = np.meshgrid(edge, edge)
    return of_grid(np.stack([x, y, np.zeros_like(x)], axis=-1))
