"""Facets: arrays (m, 4, 3) of corners in the world, counterclockwise as seen from outside.

Of a triangle the last two corners are one.
"""

import math

import numpy as np

from sinuous.checks import Floats


def of_grid(points: Floats) -> Floats:
    """Facets (m, 4, 3) of a grid of points (a, b, 3): rings, one after the other, that turn counterclockwise."""
    corners = np.stack([points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]], axis=2)
    return corners.reshape(-1, 4, 3)


def ring(center: Floats, across: Floats, radius: float, around: int) -> Floats:
    """Points (around + 1, 3) of a circle; `across` (2, 3) are two unit vectors in its plane. The first is the last."""
    turn = np.linspace(0.0, 2.0 * math.pi, around + 1)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    points: Floats = center + radius * circle @ across
    return points


def lathe(profile: Floats, around: int) -> Floats:
    """Facets of a body of revolution about z; `profile` (p, 2): distance from the axis, and place along it, upwards."""
    turn = np.linspace(0.0, 2.0 * math.pi, around + 1)
    radius, height = profile[:, :1], profile[:, 1:]
    return of_grid(np.stack(np.broadcast_arrays(radius * np.cos(turn), radius * np.sin(turn), height), axis=-1))


def normals(facets: Floats) -> Floats:
    """Outward unit normals (m, 3) of facets; zero for a facet without area."""
    across = np.cross(facets[:, 2] - facets[:, 0], facets[:, 3] - facets[:, 1])
    result: Floats = across / np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-300)
    return result


def turned(facets: Floats) -> Floats:
    """Return the same facets as seen from the other side."""
    return facets[:, ::-1]


def cut(facets: Floats, longest: float) -> Floats:
    """Cut facets in four until no side is longer, because a picture sorts them by the distance of their middles."""
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


def within(facets: Floats, low: Floats, high: Floats) -> Floats:
    """What of the facets is within a box; those that cross its sides are cut there (Sutherland & Hodgman 1974)."""
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
