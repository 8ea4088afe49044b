"""Closed triangles as bodies, each with its cavities, and which of them may overlap."""

import numpy as np

from sinuous.checks import Floats
from sinuous.scene.meshes.orientation import pieces, winding_numbers
from sinuous.scene.meshes.topology import Integers, cones


def apart(vertices: Floats, faces: Integers) -> list[Integers]:
    """Divide closed triangles into as few groups as is easy, within each of which no body overlaps another.

    Bodies are kept apart when their boxes meet; cavities go with the smallest body that is around them.

    Parameters
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray (f, 3)
        Closed and facing outwards, cavities inwards.

    Returns
    -------
    list of ndarray (g, 3)
        The faces of each group.
    """
    piece = pieces(vertices, faces)
    volumes = np.bincount(piece, cones(vertices, faces)).astype(np.float64)
    owner = _owners(vertices, faces, piece, volumes)
    low, high = _boxes(vertices, faces, piece, len(volumes))
    groups: list[list[int]] = []
    for k in np.flatnonzero(volumes > 0.0).tolist():
        for group in groups:
            if not ((low[k] <= high[group]) & (low[group] <= high[k])).all(axis=1).any():
                group.append(k)
                break
        else:
            groups.append([k])
    return [faces[np.isin(owner[piece], group)] for group in groups]


def _owners(vertices: Floats, faces: Integers, piece: Integers, volumes: Floats) -> Integers:
    """Body (k,) that each piece belongs to: itself, or the smallest that goes around a cavity."""
    owner = np.arange(len(volumes))
    solids = np.flatnonzero(volumes > 0.0)
    solids = solids[np.argsort(volumes[solids])]
    for k in np.flatnonzero(volumes <= 0.0).tolist():
        place = vertices[faces[piece == k][:1, 0]]
        around = (s for s in solids.tolist() if winding_numbers(place, vertices[faces[piece == s]])[0] > 0.5)
        owner[k] = next(around, solids[-1])
    return owner


def _boxes(vertices: Floats, faces: Integers, piece: Integers, count: int) -> tuple[Floats, Floats]:
    """Lowest and highest corner (count, 3) of every piece."""
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    corners = vertices[faces]
    np.minimum.at(low, piece, corners.min(axis=1))
    np.maximum.at(high, piece, corners.max(axis=1))
    return low, high
