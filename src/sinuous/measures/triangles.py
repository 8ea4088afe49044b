"""Distances to meshes: the closest point of every triangle that matters, and the sign by winding numbers."""

import numpy as np

from sinuous.checks import Floats
from sinuous.measures.nearest import Indices, least_distances
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.meshes.orientation import winding_numbers


def to_mesh(mesh: Mesh, points: Floats) -> Floats:
    """Signed distance (m,) of points (m, 3) to a mesh, as if the body were to stay outside."""
    corners = mesh.vertices[mesh.faces]
    centers = 0.5 * (corners.min(axis=1) + corners.max(axis=1))
    reach = np.linalg.norm(corners - centers[:, None], axis=-1).max(axis=1)

    def exact(point: Indices, triangle: Indices) -> Floats:
        return to_triangles(corners[triangle], points[point])

    distances = least_distances(points, centers, reach, exact)
    if not mesh.watertight:
        return np.asarray(distances - 0.5 * mesh.thickness)
    return np.asarray(distances * _signs(corners, points, distances))


def to_triangles(corners: Floats, points: Floats) -> Floats:
    """Distance (m,) of every point (m, 3) to the triangle (m, 3, 3) in the same row."""
    sides = np.roll(corners, -1, axis=1) - corners
    away = points[:, None] - corners
    along = ((away * sides).sum(axis=-1) / np.maximum((sides**2).sum(axis=-1), 1e-300)).clip(0.0, 1.0)
    to_edge = np.sqrt(((away - along[..., None] * sides) ** 2).sum(axis=-1)).min(axis=1)
    normal = np.cross(sides[:, 0], sides[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-300)
    above = (np.cross(sides, away) * normal[:, None]).sum(axis=-1) >= 0.0
    to_plane = np.abs((away[:, 0] * normal).sum(axis=-1))
    return np.asarray(np.where(above.all(axis=1), to_plane, to_edge))


def _signs(corners: Floats, points: Floats, distances: Floats) -> Floats:
    """Signs (m,): -1 inside. Between neighbours nearer to each other than to the surface it cannot change."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=-1)
    fresh = np.ones(len(points), bool)
    fresh[1:] = steps >= np.maximum(distances[1:], distances[:-1])
    inside = winding_numbers(points[fresh], corners) > 0.5
    signs: Floats = np.where(inside, -1.0, 1.0)[np.cumsum(fresh) - 1]
    return signs
