"""Triangles that are lines: taken out of a closed surface so that it stays closed."""

import numpy as np

from sinuous.checks import Floats
from sinuous.scene.meshes.topology import Integers, are_triangles

ROUNDS = 20
"""How often all slivers are turned into better triangles; chains of them take several rounds."""


def without_slivers(vertices: Floats, faces: Integers) -> Integers:
    """Exchange the long side of every sliver, of a closed surface, for the other diagonal of what it has beside it.

    The middle corner of a sliver lies on its long side, where the surface is stitched: the triangle on the other side
    is cut in two there, and the surface stays what it was. Triangles with a corner twice go away with the edge that
    they fill.

    Parameters
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray (f, 3)

    Returns
    -------
    ndarray (g, 3)
        With slivers left only where that could not help.
    """
    result = _with_three_corners(faces)
    for _ in range(ROUNDS):
        slivers = np.flatnonzero(~are_triangles(vertices, result))
        if not len(slivers):
            break
        result = result.copy()
        done: set[int] = set()
        for k in slivers.tolist():
            beside = _beside(vertices, result, k)
            if beside is not None and k not in done and beside[0] not in done:
                other, first, second = beside
                result[k], result[other] = first, second
                done |= {k, other}
        result = _with_three_corners(result)
    return result


def _with_three_corners(faces: Integers) -> Integers:
    a, b, c = faces.T
    result: Integers = faces[(a != b) & (b != c) & (c != a)]
    return result


def _beside(vertices: Floats, faces: Integers, k: int) -> tuple[int, list[int], list[int]] | None:
    """Triangle on the other side of the long side of sliver `k`, and the two triangles that replace both."""
    corners = vertices[faces[k]]
    longest = int(((np.roll(corners, -1, axis=0) - corners) ** 2).sum(axis=1).argmax())
    a, b, c = np.roll(faces[k], -longest).tolist()
    found = np.argwhere((faces == b) & (np.roll(faces, -1, axis=1) == a))
    if len(found) != 1:
        return None
    other, place = found[0].tolist()
    d = int(faces[other, place - 1])
    return other, [c, a, d], [b, c, d]
