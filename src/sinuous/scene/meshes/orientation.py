"""Which way triangles face: neighbours alike, and bodies outwards."""

import math

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.scene.meshes.topology import Integers, cones


def turn_alike(faces: Integers) -> tuple[Integers, int]:
    """Turn as few triangles as it takes for all neighbours to run along their edge in opposite directions.

    Parameters
    ----------
    faces : ndarray (f, 3)
        Every edge has two triangles.

    Returns
    -------
    faces : ndarray (f, 3)
    turned : int
        How many; 0 as well where there is no such way, as on a Klein bottle.
    """
    count = len(faces)
    first, second, opposed = _neighbours(faces)
    # Every triangle is there twice, as it is and turned; what fits together hangs together.
    there, back = np.where(opposed, second, second + count), np.where(opposed, second + count, second)
    label = _labels(np.concatenate([first, first + count]), np.concatenate([there, back]), 2 * count)
    as_is, turned = label[:count], label[count:]
    if (as_is == turned).any():
        return faces, 0
    sizes = np.bincount(as_is, minlength=int(label.max()) + 1)
    # The two halves of a piece are each other's mirror image: the one with more triangles as they are is right.
    flip = (sizes[as_is] < sizes[turned]) | ((sizes[as_is] == sizes[turned]) & (as_is > turned))
    result = faces.copy()
    result[flip] = faces[flip, ::-1]
    return result, int(flip.sum())


def _neighbours(faces: Integers) -> tuple[Integers, Integers, NDArray[np.bool_]]:
    """Both triangles of every edge, and whether they run along it in opposite directions."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    order = np.lexsort((np.maximum(start, end), np.minimum(start, end)))
    one, other = order[::2], order[1::2]
    return one // 3, other // 3, start[one] == end[other]


def _labels(first: Integers, second: Integers, count: int) -> Integers:
    """Number (count,) of the piece that each of `count` things belongs to, when `first` and `second` hang together."""
    from scipy.sparse import coo_array  # noqa: PLC0415
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415

    links = coo_array((np.ones(len(first), np.int8), (first, second)), (count, count))
    return np.asarray(connected_components(links, directed=False)[1], np.int64)


def pieces(vertices: Floats, faces: Integers) -> Integers:
    """Number (f,) of the piece that each triangle belongs to: triangles with a common vertex hang together."""
    label = _labels(faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel(), len(vertices))
    _, result = np.unique(label[faces[:, 0]], return_inverse=True)
    return np.asarray(result, np.int64)


def turn_outwards(vertices: Floats, faces: Integers) -> tuple[Integers, int]:
    """Turn bodies that face inwards, unless they are cavities of another body.

    Parameters
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray (f, 3)
        Closed, and neighbours face alike.

    Returns
    -------
    faces : ndarray (f, 3)
    turned : int
        How many triangles.
    """
    volumes = cones(vertices, faces)
    sign = -1.0 if volumes.sum() < 0.0 else 1.0
    result = faces[:, ::-1].copy() if sign < 0.0 else faces.copy()
    body = pieces(vertices, faces)
    for k in np.flatnonzero(np.bincount(body, sign * volumes) < 0.0):
        own = body == k
        around = winding_numbers(vertices[result[own][:1, 0]], vertices[result[~own]])
        if around[0] < 0.5:
            result[own] = result[own][:, ::-1]
    return result, int((result != faces).any(axis=1).sum())


def winding_numbers(points: Floats, corners: Floats) -> Floats:
    """How many times closed triangles, corners (f, 3, 3), go around each of `points` (m, 3): 1 inside, 0 outside.

    The solid angles of van Oosterom & Strackee (1983), summed up.
    """
    result = np.empty(len(points))
    for i, point in enumerate(points):
        a, b, c = np.moveaxis(corners - point, 1, 0)
        la, lb, lc = (np.linalg.norm(side, axis=-1) for side in (a, b, c))
        above = (a * np.cross(b, c)).sum(axis=-1)
        below = la * lb * lc + (a * b).sum(-1) * lc + (b * c).sum(-1) * la + (c * a).sum(-1) * lb
        result[i] = float(np.arctan2(above, below).sum()) / (2.0 * math.pi)
    return result
