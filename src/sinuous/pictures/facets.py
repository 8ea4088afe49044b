"""Facets: arrays (m, 4, 3) of corners in the world, counterclockwise as seen from outside.

Matplotlib sorts facets by the distance of their middles, so none may be long. A triangle repeats its last corner.
"""

import numpy as np

from sinuous.checks import Floats
from sinuous.display.surface import Surface

MOST_TRIANGLES = 12_000
"""Triangles of a mesh that are drawn; of more, vertices that fall together on a grid become one."""

FINEST, COARSEST = 96, 12
"""Cells of that grid along the longest side of the mesh."""

ROUNDING = 1e-9
"""How far corners in a plane may be off, as a share of the extent of the facets."""

LONGEST = 0.1
"""Longest side of a facet of a mesh, as a share of the longest side of the mesh."""


def of_mesh(surface: Surface, both: bool) -> Floats:
    """Small facets of a mesh of triangles; `both`: for both sides."""
    drawn = surface if len(surface.faces) <= MOST_TRIANGLES else _thinned(surface)
    facets = cut(drawn.facets, LONGEST * float(np.ptp(drawn.vertices, axis=0).max()))
    return np.concatenate([facets, facets[:, [2, 1, 0, 0]]]) if both else facets


def _thinned(surface: Surface) -> Surface:
    """Return a mesh of so few triangles that a picture can have them."""
    cells = FINEST
    thin = _clustered(surface, cells)
    while len(thin.faces) > MOST_TRIANGLES and cells > COARSEST:
        cells = 3 * cells // 4
        thin = _clustered(surface, cells)
    return thin


def _clustered(surface: Surface, cells: int) -> Surface:
    """Return a mesh in which all vertices in a cell of a grid have become their mean."""
    vertices = surface.vertices
    low, edge = vertices.min(axis=0), np.ptp(vertices, axis=0).max() / cells
    places = np.floor((vertices - low) / edge).astype(np.int64)
    _, group, count = np.unique(places, axis=0, return_inverse=True, return_counts=True)
    group = group.ravel()
    sums = np.zeros((len(count), 3))
    np.add.at(sums, group, vertices)
    faces = group[surface.faces]
    a, b, c, _ = faces.T
    return Surface(sums / count[:, None], faces[(a != b) & (b != c) & (c != a)])


def normals(facets: Floats) -> Floats:
    """Outward unit normals (m, 3) of facets; zero for a facet without area."""
    across = np.cross(facets[:, 2] - facets[:, 0], facets[:, 3] - facets[:, 1])
    return across / np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-300)


def cut(facets: Floats, longest: float) -> Floats:
    """Cut facets in four until no side is longer."""
    whole = []
    while len(facets):
        sides = np.linalg.norm(np.roll(facets, -1, axis=1) - facets, axis=-1).max(axis=1)
        whole.append(facets[sides <= longest])
        rest = facets[sides > longest]
        triangle = (rest[:, 2] == rest[:, 3]).all(axis=-1)
        facets = np.concatenate([_quarters(rest[~triangle], 4), _quarters(rest[triangle, :3], 3)])
    return np.concatenate(whole) if whole else facets


def _quarters(corners: Floats, count: int) -> Floats:
    """Cut triangles (m, 3, 3) or quadrangles (m, 4, 3) in four."""
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    if count == 3:
        parts = [np.stack([corners[:, i], middles[:, i], middles[:, i - 1]], axis=1) for i in range(3)]
        return np.concatenate([*parts, middles])[:, [0, 1, 2, 2]]
    center = corners.mean(axis=1)
    parts = [np.stack([corners[:, i], middles[:, i], center, middles[:, i - 1]], axis=1) for i in range(4)]
    return np.concatenate(parts)


def within(facets: Floats, low: Floats, high: Floats, solid: bool = False) -> Floats:
    """What of the facets is within a box; those that cross its sides are cut there (Sutherland & Hodgman 1974).

    Those of a convex `solid` are closed again where it is cut.
    """
    if solid:
        for axis in range(3):
            for side, limit in ((1.0, low[axis]), (-1.0, high[axis])):
                facets = _closed(facets, axis, side, limit)
        return facets
    whole = ((facets >= low) & (facets <= high)).all(axis=(1, 2))
    beyond = np.any(np.all(facets < low, axis=1) | np.all(facets > high, axis=1), axis=1)
    parts = [facets[whole]]
    for corners in facets[~whole & ~beyond]:
        polygon = corners
        for axis in range(3):
            for side, limit in ((1.0, low[axis]), (-1.0, high[axis])):
                polygon = _above(polygon, side * (polygon[:, axis] - limit))
        parts += [_fan(polygon)] if len(polygon) > 2 else []
    return np.concatenate(parts)


def _closed(facets: Floats, axis: int, side: float, limit: float) -> Floats:
    """What of a convex solid is on one side of a plane across an axis, with a face in the plane."""
    heights = side * (facets[..., axis] - limit)
    below, above = heights.min(axis=1), heights.max(axis=1)
    if not len(facets) or below.min() >= 0.0:
        return facets
    crossed = (below < 0.0) & (above > 0.0)
    polygons = [_above(corners, own) for corners, own in zip(facets[crossed], heights[crossed], strict=True)]
    kept = np.concatenate([facets[below >= 0.0], *(_fan(polygon) for polygon in polygons if len(polygon) > 2)])
    corners = kept.reshape(-1, 3)
    rim = corners[np.abs(corners[:, axis] - limit) < ROUNDING * np.ptp(facets, axis=(0, 1)).max()]
    if len(rim) < 3:
        return kept
    across, up = (rim[:, (axis + k) % 3] - rim[:, (axis + k) % 3].mean() for k in (1, 2))
    return np.concatenate([kept, _fan(rim[np.argsort(-side * np.arctan2(up, across), kind="stable")])])


def _above(polygon: Floats, heights: Floats) -> Floats:
    """Return the part of a convex polygon (k, 3) whose heights (k,) over a plane are not below 0."""
    kept = []
    for k in range(len(polygon)):
        if heights[k] >= 0.0:
            kept.append(polygon[k])
        after = (k + 1) % len(polygon)
        if heights[k] * heights[after] < 0.0:
            share = heights[k] / (heights[k] - heights[after])
            kept.append(polygon[k] + share * (polygon[after] - polygon[k]))
    return np.array(kept).reshape(-1, 3)


def _fan(polygon: Floats) -> Floats:
    """Facets (m, 4, 3) of a convex polygon (k, 3)."""
    last = len(polygon) - 1
    return np.array([polygon[[0, k, min(k + 1, last), min(k + 2, last)]] for k in range(1, last, 2)])
