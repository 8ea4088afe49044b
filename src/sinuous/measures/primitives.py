"""Distances to the exact obstacles, by their closest points."""

import numpy as np

from sinuous.checks import Floats
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Primitive, Sphere


def to_primitive(obstacle: Primitive, points: Floats) -> Floats:
    """Signed distance (m,) of points (m, 3) to an exact obstacle, as if the body were to stay outside."""
    if isinstance(obstacle, Sphere):
        distance = np.linalg.norm(points - obstacle.center, axis=-1) - obstacle.radius
    elif isinstance(obstacle, Box):
        distance = to_boxes((points - obstacle.center) @ obstacle.rotation, 0.5 * obstacle.size)
    elif isinstance(obstacle, Capsule):
        foot = obstacle.start + _along(obstacle, points).clip(0.0, 1.0)[:, None] * (obstacle.end - obstacle.start)
        distance = np.linalg.norm(points - foot, axis=-1) - obstacle.radius
    elif isinstance(obstacle, Cylinder):
        t, span = _along(obstacle, points), obstacle.end - obstacle.start
        axial = (np.abs(t - 0.5) - 0.5) * np.linalg.norm(span)
        radial = np.linalg.norm(points - obstacle.start - t[:, None] * span, axis=-1) - obstacle.radius
        distance = _corner(np.stack([axial, radial], axis=-1))
    elif isinstance(obstacle, HalfSpace):
        distance = (points - obstacle.point) @ obstacle.normal
    else:
        raise NotImplementedError(f"no independent distance for {type(obstacle).__name__}")
    return np.asarray(distance)


def _along(obstacle: Capsule | Cylinder, points: Floats) -> Floats:
    """Where points project on the axis: 0 at its start, 1 at its end."""
    span = obstacle.end - obstacle.start
    square = float(span @ span)
    result: Floats = (points - obstacle.start) @ span / (square if square > 0.0 else 1.0)
    return result


def to_boxes(points: Floats, half: Floats) -> Floats:
    """Signed distance (m,) of points (m, 3) to a box about the origin with these half extents (3,)."""
    return _corner(np.abs(points) - half)


def _corner(excess: Floats) -> Floats:
    """Distance to where all of `excess` (m, d) are negative."""
    outside = np.linalg.norm(np.maximum(excess, 0.0), axis=-1)
    return np.asarray(np.where(outside > 0.0, outside, excess.max(axis=-1)))
