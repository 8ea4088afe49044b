"""Normals by which a point is known to be inside or outside of triangles, whichever part of one is closest."""

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats


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
    start, end = faces, np.roll(faces, -1, axis=1)
    key = np.minimum(start, end) * len(vertices) + np.maximum(start, end)
    _, edge = np.unique(key, return_inverse=True)
    edge = edge.reshape(faces.shape)
    at_edges = _gather(edge, np.broadcast_to(flat[:, None], corners.shape), int(edge.max()) + 1)
    return np.concatenate([flat[:, None], at_edges, at_corners], axis=1)


def _gather(index: NDArray[np.int64], vectors: Floats, count: int) -> Floats:
    """Sum vectors (f, 3, 3) by their index (f, 3), and give everyone the direction of the sum of its own."""
    sums = [np.bincount(index.ravel(), vectors[..., axis].ravel(), count) for axis in range(3)]
    result: Floats = _unit(np.stack(sums, axis=-1))[index]
    return result


def _unit(vectors: Floats) -> Floats:
    """Scale vectors (..., 3) to length 1; zero stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    result: Floats = vectors / np.where(length > 0.0, length, 1.0)
    return result
