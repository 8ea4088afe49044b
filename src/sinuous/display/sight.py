"""What stands between a viewer and a body: spheres, half-spaces, and of everything else the box around it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.scene.extents import box_of
from sinuous.scene.obstacles import Capsule, HalfSpace, Obstacle, Primitive, Sphere

HIDDEN = 0.03
"""Share of a body from which on an obstacle hides it."""


def hidden(obstacles: Sequence[Obstacle], points: Floats, eyes: Floats) -> NDArray[np.bool_]:
    """Which obstacles stand between points (m, 3) and eyes (e, 3): truth values (k, e, m).

    What a body must stay inside of never does: pages draw its far side alone. Obstacles stand still.
    """
    found = np.zeros((len(obstacles), len(eyes), len(points)), np.bool_)
    for own, obstacle in zip(found, obstacles, strict=True):
        if not getattr(obstacle, "inside", False):
            own[...] = _between(obstacle, points, eyes)
    return found


def hiding(obstacles: Sequence[Obstacle], points: Floats, eyes: Floats) -> frozenset[int]:
    """Indices of the obstacles that hide more than a small part of the points (m, 3) from one of the eyes (e, 3)."""
    if not (len(points) and len(eyes)):
        return frozenset()
    shares = hidden(obstacles, points, eyes).mean(axis=-1).max(axis=-1)
    return frozenset(np.flatnonzero(shares > HIDDEN).tolist())


def _between(obstacle: Obstacle, points: Floats, eyes: Floats) -> NDArray[np.bool_]:
    """Whether an obstacle meets the lines (e, m) from points to eyes."""
    if isinstance(obstacle, HalfSpace):
        behind = (eyes - obstacle.point) @ obstacle.normal < 0.0
        return np.repeat(behind[:, None], len(points), axis=1)
    center, rotation, half = _box(obstacle)
    begin = (points - center) @ rotation / half
    along = (eyes[:, None] - points) @ rotation / half
    if isinstance(obstacle, Sphere):
        near = np.clip(-(along * begin).sum(axis=-1) / (along**2).sum(axis=-1), 0.0, 1.0)
        return ((begin + near[..., None] * along) ** 2).sum(axis=-1) < 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        sides = np.stack([(-1.0 - begin) / along, (1.0 - begin) / along])
    enters, leaves = sides.min(axis=0).max(axis=-1), sides.max(axis=0).min(axis=-1)
    return np.maximum(enters, 0.0) < np.minimum(leaves, 1.0)


def _box(obstacle: Obstacle) -> tuple[Floats, Floats, Floats]:
    """Center, axes and half extents of the box around an obstacle."""
    if isinstance(obstacle, Primitive):
        center, rotation, half = obstacle.frame
        if isinstance(obstacle, Sphere):
            half = np.full(3, obstacle.radius)
        if isinstance(obstacle, Capsule):
            half = np.array([obstacle.radius, obstacle.radius, half[2] + obstacle.radius])
    else:
        ends = box_of(obstacle)
        if ends is None:  # an empty grid
            return np.full(3, np.inf), np.eye(3), np.ones(3)
        center, rotation, half = ends.mean(axis=0), np.eye(3), 0.5 * np.ptp(ends, axis=0)
    return center, rotation, np.maximum(half, 1e-9 * (1.0 + np.abs(center).max()))
