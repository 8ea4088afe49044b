"""Signed distances to many exact shapes at once, all of one kind in one go."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial.distance import cdist

from sinuous.checks import Floats
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Primitive, Sphere

Distance = Callable[[Floats], Floats]
"""Signed distances (m,) of points (m, 3): the least over all obstacles."""


def distances_to(obstacles: Sequence[Primitive]) -> list[Distance]:
    """Prepare the distance to all obstacles, one function a kind."""
    found = []
    for kind, prepare in KINDS.items():
        own = [obstacle for obstacle in obstacles if type(obstacle) is kind]
        if own:
            found.append(_least(prepare(own), _signs(own)))
    return found


def _signs(obstacles: Sequence[Primitive]) -> Floats:
    return np.array([-1.0 if getattr(obstacle, "inside", False) else 1.0 for obstacle in obstacles])


def _least(outside: Distance, signs: Floats) -> Distance:
    """The least of distances (m, k), turned round where the body must stay inside."""
    return lambda points: np.asarray((outside(points) * signs).min(axis=1))


def _gathered(obstacles: Sequence[Primitive], name: str) -> Floats:
    return np.array([getattr(obstacle, name) for obstacle in obstacles], np.float64)


def _spheres(obstacles: Sequence[Primitive]) -> Distance:
    centers, radii = _gathered(obstacles, "center"), _gathered(obstacles, "radius")
    return lambda points: np.asarray(cdist(points, centers) - radii)


def _boxes(obstacles: Sequence[Primitive]) -> Distance:
    centers, halves = _gathered(obstacles, "center"), 0.5 * _gathered(obstacles, "size")
    axes = _gathered(obstacles, "rotation")
    return lambda points: _corner(np.abs(np.einsum("mki,kij->mkj", points[:, None] - centers, axes)) - halves)


def _capsules(obstacles: Sequence[Primitive]) -> Distance:
    axes, radii = _Axes(obstacles), _gathered(obstacles, "radius")

    def distance(points: Floats) -> Floats:
        beyond, aside = axes.beyond_and_aside(points)
        return np.asarray(np.hypot(np.maximum(beyond, 0.0), aside) - radii)

    return distance


def _cylinders(obstacles: Sequence[Primitive]) -> Distance:
    axes, radii = _Axes(obstacles), _gathered(obstacles, "radius")

    def distance(points: Floats) -> Floats:
        beyond, aside = axes.beyond_and_aside(points)
        return _corner(np.stack([beyond, aside - radii], axis=-1))

    return distance


class _Axes:
    """Axes from start to end of k obstacles."""

    def __init__(self, obstacles: Sequence[Primitive]) -> None:
        starts, ends = _gathered(obstacles, "start"), _gathered(obstacles, "end")
        lengths = np.linalg.norm(ends - starts, axis=1)
        self._halves, self._middles = 0.5 * lengths, 0.5 * (starts + ends)
        long = lengths[:, None] > 0.0
        self._units = np.divide(ends - starts, lengths[:, None], out=np.zeros_like(starts), where=long)

    def beyond_and_aside(self, points: Floats) -> tuple[Floats, Floats]:
        """How far points (m, 3) are beyond the nearer end of each axis, and aside of it (m, k)."""
        offsets = points[:, None] - self._middles
        along = (offsets * self._units).sum(axis=-1)
        return np.abs(along) - self._halves, _norm(offsets - along[..., None] * self._units)


def _half_spaces(obstacles: Sequence[Primitive]) -> Distance:
    places, normals = _gathered(obstacles, "point"), _gathered(obstacles, "normal")
    return lambda points: ((points[:, None] - places) * normals).sum(axis=-1)


def _norm(vectors: Floats) -> Floats:
    return np.asarray(np.sqrt((vectors * vectors).sum(axis=-1)))


def _corner(excess: Floats) -> Floats:
    """Distance to where all of `excess` (..., d) are negative."""
    most = excess.max(axis=-1)
    return np.asarray(np.where(most > 0.0, _norm(np.maximum(excess, 0.0)), most))


KINDS: dict[type[Primitive], Callable[[Sequence[Primitive]], Distance]] = {
    Sphere: _spheres,
    Box: _boxes,
    Capsule: _capsules,
    Cylinder: _cylinders,
    HalfSpace: _half_spaces,
}
