"""Triangles as a file brings them: what is mended, what is only said, and the closed bodies that they make.

Bodies have cavities, may overlap, and may cut through themselves.
"""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, counted
from sinuous.scene.trees import tree_of_boxes

Integers = NDArray[np.int64]

HASH_FACTOR = np.uint64(0x9E3779B97F4A7C15)
"""What mixes the bits of coordinates: 2^64 over the golden ratio."""

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
    sides = np.sort(2 * number + (start < end))
    first = np.flatnonzero(np.diff(sides >> 1, prepend=-1))
    count = np.diff(first, append=len(sides))
    two = first[count == 2]
    return Edges(int((count == 1).sum()), int((count > 2).sum()), int((sides[two] == sides[two + 1]).sum()))


def merge_equal(vertices: Floats, faces: Integers) -> tuple[Floats, Integers]:
    """Make one vertex of all that are exactly equal: STL files repeat them for every triangle."""
    clean = vertices + 0.0  # -0 and 0 are one place
    mixed = np.zeros(len(clean), np.uint64)
    for bits in clean.view(np.uint64).T:
        mixed += bits
        mixed = (mixed ^ (mixed >> np.uint64(32))) * HASH_FACTOR
    order = np.argsort(mixed)
    new = np.append(True, np.diff(mixed[order]) != 0)
    place = np.cumsum(new) - 1
    some = clean[order[new]]
    if (some[place] != clean[order]).any():  # two places have one hash: a chance in a million for a million vertices
        some, order, place = clean, np.arange(len(clean)), np.arange(len(clean))
    sorting = np.lexsort(some.T)
    firsts = np.append(True, (np.diff(some[sorting], axis=0) != 0.0).any(axis=1))
    rank = np.empty(len(some), np.int64)
    rank[sorting] = np.cumsum(firsts) - 1
    merged = np.empty(len(clean), np.int64)
    merged[order] = rank[place]
    return some[sorting[firsts]], merged[faces]


def drop_unused(vertices: Floats, faces: Integers) -> tuple[Floats, Integers]:
    """Keep the vertices that a triangle has, in their order."""
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    return vertices[used], (np.cumsum(used) - 1)[faces]


def are_triangles(vertices: Floats, faces: Integers) -> NDArray[np.bool_]:
    """Tell (f,) which of `faces` have an area and are no mere lines or points."""
    a, b, c = (vertices[corner].T for corner in faces.T)
    first, second, third = b - a, c - b, a - c
    longest = np.maximum(np.maximum(_square(first), _square(second)), _square(third))
    area = np.sqrt(_square(cross(first, second)))
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
    about = vertices - middle
    a, b, c = (about[corner].T for corner in faces.T)
    x, y, z = a * cross(b, c)
    return np.asarray((x + y + z) / 6.0)


def cross(a: Floats, b: Floats) -> Floats:
    """Cross products (3, m) of vectors (3, m); NumPy's own takes several times as long."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _square(vectors: Floats) -> Floats:
    """Squared lengths (m,) of vectors (3, m)."""
    x, y, z = vectors
    return np.asarray(x * x + y * y + z * z)


def size_of(vectors: Floats) -> Floats:
    """Lengths (m,) of vectors (3, m)."""
    return np.asarray(np.sqrt(_square(vectors)))


def with_planes(corners: Floats) -> Floats:
    """Numbers (m, 13) of triangles: corners, unit normal, offset of the plane."""
    a, b, c = (corner.T for corner in np.moveaxis(corners, 1, 0))
    normals = cross(b - a, c - a)
    normals /= size_of(normals)
    x, y, z = normals * a
    return np.concatenate([corners.reshape(-1, 9), normals.T, (x + y + z)[:, None]], axis=1)


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


Flags = NDArray[np.bool_]


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


def boxes_of(corners: Floats) -> tuple[Floats, Floats]:
    """Lowest and highest corner (f, 3) of triangles (f, 3, 3); NumPy takes five times as long along a short axis."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def _boxes(vertices: Floats, faces: Integers, piece: Integers, count: int) -> tuple[Floats, Floats]:
    """Lowest and highest corner (count, 3) of every piece."""
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    lows, highs = boxes_of(vertices[faces])
    np.minimum.at(low, piece, lows)
    np.maximum.at(high, piece, highs)
    return low, high


ROOM_FOR_PAIRS = 16
"""Pairs of triangles to a triangle that there is room for at once; most have one or two."""

SHARE, THREADS = 2**15, 2
"""Triangles of which pairs are looked for at once, and threads that do so."""

ROUNDED, PLACED = 1e-13, 4e-16
"""What counts as no volume of a tetrahedron, in cubes of its size; and more, in squares of that times the extent."""

INWARDS = 1e-7
"""How far below its surface a body is looked at, relative to its extent."""


def bodies_overlap(vertices: Floats, faces: Integers) -> bool:
    """Whether bodies of one mesh overlap, or a cavity reaches out of its body: exactly, however thin what they share.

    Then distances to the nearest triangle do not tell which side of the whole a place is on. Where no triangles of two
    closed surfaces cross, each lies on one side of the other, which a single place tells. Where they touch, like faces
    in one plane, all triangles that do are asked.

    Parameters
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray (f, 3)
        Closed and facing outwards, cavities inwards.
    """
    piece = pieces(vertices, faces)
    low, high = _boxes(vertices, faces, piece, int(piece.max()) + 1)
    meet = [np.flatnonzero(((low <= high[k]) & (low[k] <= high)).all(axis=1)) for k in range(len(low))]
    crowded = np.array([k for k, others in enumerate(meet) if len(others) > 1], np.int64)
    if not len(crowded):
        return False
    own = np.isin(piece, crowded)
    surface, body = _Surface.of(vertices, faces), piece[own]
    touching = surface.touching(np.flatnonzero(own), body, same=False)
    if touching is None:
        return True
    order = np.lexsort((surface.areas, piece))
    largest = order[np.append(np.flatnonzero(np.diff(piece[order])), len(order) - 1)]
    return surface.is_covered_twice(touching | set(largest[crowded].tolist()))


def cuts_itself(vertices: Floats, faces: Integers) -> bool:
    """Whether a surface in one piece cuts through itself, or overlaps itself: exactly, however little it does.

    Then the closest triangle does not tell which side a place is on. Triangles that have at most one vertex in common
    must not cross. Where they only touch, what is just below them must be inside once.

    Parameters
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray (f, 3)
        Closed and facing outwards, cavities inwards.
    """
    piece = pieces(vertices, faces)
    surface = _Surface.of(vertices, faces)
    touching = surface.touching(np.arange(len(faces)), piece, same=True)
    if touching is None:
        return True
    touched = np.array(sorted(touching), np.int64)
    for k in np.unique(piece[touched]).tolist():
        one = _Surface.of(vertices, faces[piece == k])
        places = np.searchsorted(np.flatnonzero(piece == k), touched[piece[touched] == k])
        if one.is_covered_twice(set(places.tolist())):
            return True
    return False


class _Surface(NamedTuple):
    """Triangles about the origin, where rounding is that of the extent, wherever the mesh stands.

    Attributes
    ----------
    faces : ndarray (f, 3)
        Vertices of every triangle.
    corners : ndarray (f, 3, 3)
    normals : ndarray (f, 3)
        Unit vectors.
    areas, sizes : ndarray (f,)
        Twice the area, and the longest side of the box.
    tiny : ndarray (f,)
        What rounding may move a corner by.
    """

    faces: Integers
    corners: Floats
    normals: Floats
    areas: Floats
    sizes: Floats
    tiny: Floats

    @classmethod
    def of(cls, vertices: Floats, faces: Integers) -> "_Surface":
        """Make it of the triangles of a mesh, about their middle."""
        corners = vertices[faces]
        lows, highs = boxes_of(corners)
        corners -= 0.5 * (lows.min(axis=0) + highs.max(axis=0))
        normals, areas = _normals(corners)
        sizes = (highs - lows).max(axis=1)
        return cls(faces, corners, normals, areas, sizes, ROUNDED * sizes + PLACED * float(np.abs(corners).max()))

    def touching(self, those: Integers, body: Integers, *, same: bool) -> set[int] | None:
        """Which of `those` triangles (k,) only touch another one; `None` where one crosses another.

        Only pairs of the `same` body (k,), or of two, are held against each other.
        """
        tree = self._tree(those, body)
        if len(those) <= SHARE:  # of hundreds of small meshes, threads take longer to begin
            return self._touching(tree, 0, same)
        with ThreadPoolExecutor(THREADS) as threads:
            shares = [threads.submit(self._touching, tree, first, same) for first in range(0, len(those), SHARE)]
            try:
                found = [share.result() for share in shares]
            finally:
                threads.shutdown(cancel_futures=True)
        return None if None in found else set[int]().union(*(each for each in found if each))

    def _tree(self, those: Integers, body: Integers) -> tuple[Any, ...]:
        """Numbers of `those` triangles in the order of a tree over them, and what the search for pairs reads of it."""
        corners = self.corners[those]
        order, levels, nodes = tree_of_boxes(corners.mean(axis=1), *boxes_of(corners))
        own = those[order]
        return own, nodes, levels, self.faces[own], corners[order], self.normals[own], self.tiny[own], body[order]

    def _touching(self, tree: tuple[Any, ...], first: int, same: bool) -> set[int] | None:
        """See `touching`; pairs of the `SHARE` triangles from `first` on with those behind them."""
        from sinuous.kernels.fields.triangle_pairs import gather_pairs  # noqa: PLC0415

        corners, touched = self.corners, set[int]()
        own, nodes, levels, faces, places, normals, tiny_of, body = tree
        last = min(first + SHARE, len(own))
        pairs = np.empty((ROOM_FOR_PAIRS * len(own) + 1, 3), np.int64)
        while first < last:
            found = gather_pairs(nodes, levels, faces, places, normals, tiny_of, body, int(same), first, last, pairs)
            first = last if found >= 0 else -1 - found
            i, j, common = pairs[: found if found >= 0 else int((pairs[:, 0] < 0).argmax())].T
            i, j = own[i], own[j]
            tiny = np.maximum(self.tiny[i], self.tiny[j])
            small = np.maximum(self.sizes[i], self.sizes[j]) ** 2 * tiny
            for a, b in ((i, j), (j, i)):
                crossing, near = _edges_meet(corners[a], corners[b], small)
                if crossing.any():
                    return None
                near &= common == 0
                near[near] = ~_apart(corners[i[near]], corners[j[near]], tiny[near])
                touched |= {*i[near].tolist(), *j[near].tolist()}
        return touched

    def is_covered_twice(self, triangles: set[int]) -> bool:
        """Whether what is just below some triangles is inside more than once, or not at all.

        Of a cavity alone the material is outside of the surface: what is just below must not be inside.
        """
        asked, corners = np.array(sorted(triangles), np.intp), self.corners
        step = INWARDS * float(np.ptp(corners.reshape(-1, 3), axis=0).max())
        below = winding_numbers(corners[asked].mean(axis=1) - step * self.normals[asked], corners)
        outwards = cones(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)).sum() > 0.0
        return bool((np.abs(below - float(outwards)) > 0.5).any())


def _apart(one: Floats, other: Floats, tiny: Floats) -> Flags:
    """Whether triangles (m, 3, 3) are farther apart than `tiny` (m,), beyond an edge of one of them within its plane.

    So are most neighbours in a plane face that have no corner in common: their planes tell nothing.
    """
    result: Flags = np.zeros(len(one), np.bool_)
    for a, b in ((one, other), (other, one)):
        edges = np.roll(a, -1, axis=1) - a
        aside = np.cross(edges, _normals(a)[0][:, None])
        aside /= np.linalg.norm(aside, axis=2)[:, :, None]
        for e in range(3):
            place = np.einsum("mx,mx->m", aside[:, e], a[:, e])  # of the edge; its triangle lies below
            result |= (np.einsum("mx,mkx->mk", aside[:, e], b) - place[:, None]).min(axis=1) > tiny
    return result


def _normals(corners: Floats) -> tuple[Floats, Floats]:
    """Unit normals (f, 3) of triangles (f, 3, 3), and twice their areas (f,)."""
    sides = cross((corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T).T
    areas = np.sqrt(_square(sides.T))
    return np.ascontiguousarray(sides / areas[:, None]), areas


def _edges_meet(edges: Floats, triangles: Floats, small: Floats) -> tuple[Flags, Flags]:
    """Whether an edge of a triangle (m, 3, 3) passes through another one (m,), and whether one only just may.

    Volumes up to `small` (m,) are none.
    """
    crossing, touching = np.zeros((2, len(edges)), bool)
    a, b, c = np.moveaxis(triangles, 1, 0)
    for k in range(3):
        p, q = edges[:, k], edges[:, (k + 1) % 3]
        sides = np.stack([_volume(p, a, b, c), _volume(q, a, b, c)])
        about = np.stack([_volume(p, q, a, b), _volume(p, q, b, c), _volume(p, q, c, a)])
        apart = ((sides > small).all(axis=0)) | ((sides < -small).all(axis=0))
        apart |= (about > small).any(axis=0) & (about < -small).any(axis=0)
        sure = (np.abs(sides) > small).all(axis=0) & (np.abs(about) > small).all(axis=0)
        crossing |= ~apart & sure
        touching |= ~apart & ~sure
    return crossing, touching


def _volume(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Six times the signed volume (m,) of tetrahedra with these corners (m, 3)."""
    (x, y, z), (u, v, w), (r, s, t) = (b - a).T, (c - a).T, (d - a).T
    return x * (v * t - w * s) + y * (w * r - u * t) + z * (u * s - v * r)
