"""Signed distances to many exact shapes at once, all of one kind in one go."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial.distance import cdist

from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Primitive, Sphere

Precision = type[np.float64] | type[np.longdouble]

Distance = Callable[[Floats], Floats]
"""Signed distances (m,) of points (m, 3): the least over all obstacles."""


LARGE = 1e3
"""Coordinates of obstacles beyond which extended precision is used, in those of the points that are asked for."""


def distances_to(obstacles: Sequence[Primitive], size: float = math.inf) -> list[Distance]:
    """Prepare the distance to all obstacles, one function a kind.

    Parameters
    ----------
    obstacles : sequence of Primitive
    size : float
        Of the coordinates of the points that will be asked for: where those of obstacles are `LARGE` times as large,
        distances are computed in extended precision.
    """
    unknown = {type(each).__name__ for each in obstacles} - {kind.__name__ for kind in KINDS}
    if unknown:
        raise NotImplementedError(f"no distance to {', '.join(sorted(unknown))}")
    found = []
    for kind, prepare in KINDS.items():
        own = [obstacle for obstacle in obstacles if type(obstacle) is kind]
        for large in (False, True):
            some = [obstacle for obstacle in own if (_largest(obstacle) > LARGE * size) is large]
            if some:
                found.append(_least(prepare(some, np.longdouble if large else np.float64), _signs(some)))
    return found


def _largest(obstacle: Primitive) -> float:
    """No coordinate of what describes an obstacle is larger."""
    center, _, half, rounding = obstacle.frame
    return float(np.abs(center).max() + np.linalg.norm(half) + rounding)


def _signs(obstacles: Sequence[Primitive]) -> Floats:
    return np.array([-1.0 if obstacle.inside else 1.0 for obstacle in obstacles])


def _least(outside: Distance, signs: Floats) -> Distance:
    """The least of distances (m, k), turned round where the body must stay inside."""
    return lambda points: np.asarray((outside(points) * signs).min(axis=1), np.float64)


def _gathered(obstacles: Sequence[Primitive], name: str, precision: Precision) -> Floats:
    return np.array([getattr(obstacle, name) for obstacle in obstacles], precision)


def _spheres(obstacles: Sequence[Primitive], precision: Precision) -> Distance:
    centers, radii = _gathered(obstacles, "center", precision), _gathered(obstacles, "radius", precision)
    if precision is np.longdouble:
        return lambda points: _norm(points[:, None] - centers) - radii
    return lambda points: np.asarray(cdist(points, centers) - radii)


def _boxes(obstacles: Sequence[Primitive], precision: Precision) -> Distance:
    centers, halves = _gathered(obstacles, "center", precision), 0.5 * _gathered(obstacles, "size", precision)
    axes = _gathered(obstacles, "rotation", precision)
    return lambda points: _corner(np.abs(np.einsum("mki,kij->mkj", points[:, None] - centers, axes)) - halves)


def _capsules(obstacles: Sequence[Primitive], precision: Precision) -> Distance:
    axes, radii = _Axes(obstacles, precision), _gathered(obstacles, "radius", precision)

    def distance(points: Floats) -> Floats:
        beyond, aside = axes.beyond_and_aside(points)
        return np.asarray(np.hypot(np.maximum(beyond, 0.0), aside) - radii)

    return distance


def _cylinders(obstacles: Sequence[Primitive], precision: Precision) -> Distance:
    axes, radii = _Axes(obstacles, precision), _gathered(obstacles, "radius", precision)

    def distance(points: Floats) -> Floats:
        beyond, aside = axes.beyond_and_aside(points)
        return _corner(np.stack([beyond, aside - radii], axis=-1))

    return distance


class _Axes:
    """Axes from start to end of k obstacles."""

    def __init__(self, obstacles: Sequence[Primitive], precision: Precision) -> None:
        starts, ends = _gathered(obstacles, "start", precision), _gathered(obstacles, "end", precision)
        lengths = np.linalg.norm(ends - starts, axis=1)
        self._halves, self._middles = 0.5 * lengths, 0.5 * (starts + ends)
        long = lengths[:, None] > 0.0
        self._units = np.divide(ends - starts, lengths[:, None], out=np.zeros_like(starts), where=long)

    def beyond_and_aside(self, points: Floats) -> tuple[Floats, Floats]:
        """How far points (m, 3) are beyond the nearer end of each axis, and aside of it (m, k)."""
        offsets = points[:, None] - self._middles
        along = (offsets * self._units).sum(axis=-1)
        return np.abs(along) - self._halves, _norm(offsets - along[..., None] * self._units)


def _half_spaces(obstacles: Sequence[Primitive], precision: Precision) -> Distance:
    places, normals = _gathered(obstacles, "point", precision), _gathered(obstacles, "normal", precision)
    return lambda points: ((points[:, None] - places) * normals).sum(axis=-1)


def _norm(vectors: Floats) -> Floats:
    return np.asarray(np.sqrt((vectors * vectors).sum(axis=-1)))


def _corner(excess: Floats) -> Floats:
    """Distance to where all of `excess` (..., d) are negative."""
    most = excess.max(axis=-1)
    return np.asarray(np.where(most > 0.0, _norm(np.maximum(excess, 0.0)), most))


KINDS: dict[type[Primitive], Callable[[Sequence[Primitive], Precision], Distance]] = {
    Sphere: _spheres,
    Box: _boxes,
    Capsule: _capsules,
    Cylinder: _cylinders,
    HalfSpace: _half_spaces,
}
