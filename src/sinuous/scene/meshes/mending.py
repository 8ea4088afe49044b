"""What may be wrong with triangles from a file: what is mended, what is only said."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.words import counted

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


def sides_of(faces: Integers) -> tuple[Integers, Integers, Integers]:
    """First and last vertex of the sides (3 f,) of triangles (f, 3), and numbers that sides on one edge share."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    return start, end, np.minimum(start, end) * (int(faces.max()) + 1) + np.maximum(start, end)


def count_edges(faces: Integers) -> Edges:
    """Count the edges of `faces` (f, 3) that are not as those of a closed surface."""
    start, end, number = sides_of(faces)
    _, edge, count = np.unique(number, return_inverse=True, return_counts=True)
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


def enclosed_volume(vertices: Floats, faces: Integers) -> float:
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
    return (a * np.cross(b, c)).sum(axis=-1) / 6.0


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
    start, end, number = sides_of(faces)
    order = np.argsort(number, kind="stable")
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
    return faces[(a != b) & (b != c) & (c != a)]


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


def mend(vertices: Floats, faces: Integers) -> tuple[Floats, Integers, bool, list[str]]:
    """Mend triangles as far as that is certain.

    Parameters
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray (f, 3)

    Returns
    -------
    vertices, faces : ndarray
        Those worth keeping.
    solid : bool
        Whether they enclose a solid.
    defects : list of str
        What was not as it should be, and what became of it; last what keeps it from being a solid.

    Raises
    ------
    InputError
        When no triangle has an area.
    """
    defects = []
    if not count_edges(faces).closed:
        vertices, faces = merge_equal(vertices, faces)
    good = are_triangles(vertices, faces)
    if not good.any():
        raise InputError("faces", "has only triangles without area", len(faces), "at least one triangle with an area")
    if not good.all():
        defects.append(f"{counted(int((~good).sum()), 'triangle')} without area dropped")
        if count_edges(faces).closed:
            faces = without_slivers(vertices, faces)
        faces = faces[are_triangles(vertices, faces)]
    vertices, faces = drop_unused(vertices, faces)
    edges = count_edges(faces)
    if edges.clashing and not edges.border and not edges.crowded:
        faces, turned = turn_alike(faces)
        defects += _turned(turned, "another way than the neighbours")
        edges = count_edges(faces)
    if edges.closed:
        faces, turned = turn_outwards(vertices, faces)
        defects += _turned(turned, "inwards")
    volume = enclosed_volume(vertices, faces)
    reason = _open(edges, volume)
    if reason:
        defects.append(f"{reason}, so it is used as a shell and not as a solid")
    return vertices, faces, not reason, defects


def _turned(count: int, how: str) -> list[str]:
    were = "was" if count == 1 else "were"
    return [f"{counted(count, 'triangle')} faced {how} and {were} turned"] if count else []


def _open(edges: Edges, volume: float) -> str:
    """Say why triangles enclose no solid; nothing when they do."""
    found = [
        f"{counted(count, 'edge')} {what}"
        for count, what in (
            (edges.border, "with one triangle only (holes)"),
            (edges.crowded, "with more than two triangles (not manifold)"),
            (edges.clashing, "between triangles that face opposite ways"),
        )
        if count
    ]
    return ", ".join(found) or ("" if volume else "encloses no volume")
