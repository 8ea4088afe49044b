"""The distance of points to any obstacle: exact shapes, meshes, clouds, grids, functions.

Exact shapes by their closest points; meshes by the closest point of every triangle that matters, and the sign by
winding numbers. The nearest of many small things is found exactly: each lies in a ball, and balls that are too far
away are passed over.
"""

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.scene.grids import Field, Grid, evaluate
from sinuous.scene.mesh import Mesh
from sinuous.scene.moving import Moving
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Primitive, Sphere
from sinuous.scene.point_cloud import PointCloud
from sinuous.scene.triangles import winding_numbers


def measure(obstacle: Obstacle, points: Floats) -> Floats:
    """Signed distance (m,) of points (m, 3) to one obstacle, positive where the body may be.

    Of a grid of distances it is what these prove, a lower bound.
    """
    if isinstance(obstacle, Primitive):
        distance = to_primitive(obstacle, points)
    elif isinstance(obstacle, Mesh):
        distance = to_mesh(obstacle, points)
    elif isinstance(obstacle, PointCloud):
        distance = to_cloud(obstacle, points)
    elif isinstance(obstacle, Grid):
        distance = to_grid(obstacle, _steps(obstacle, points))
    elif isinstance(obstacle, Field):
        distance = to_field(obstacle, points)
    else:
        raise NotImplementedError(f"no independent distance for {type(obstacle).__name__}")
    return np.asarray(-distance if obstacle.inside else distance)


UNSURE = 1e-9
"""What arithmetic may make of a bound, as a share of it and of what it is about."""


def seen_from(obstacle: Obstacle, places: Floats, when: Floats | None) -> tuple[Obstacle, Floats]:
    """Return an obstacle as it is described, and places (T, r, 3) at times (T,), if it moves, in that frame."""
    if when is None or not isinstance(obstacle, Moving):
        return obstacle, places
    positions, rotations = obstacle.course.poses(when)
    return obstacle.obstacle, (places - positions[:, None]) @ rotations


def that_matter(
    obstacles: Sequence[Obstacle], runs: Floats, sizes: Floats, when: Floats | None = None
) -> Iterator[tuple[int, NDArray[np.bool_]]]:
    """Yield each obstacle that may be the nearest to a body, by its number, and the runs (T, r) to which it may be.

    Distances of points differ by no more than the points are apart: so one place of each run says how near the others
    can be. Grids of distances and functions, of which that is not known, always matter.

    Parameters
    ----------
    obstacles : sequence of Obstacle
    runs : ndarray (T, r, s, 3)
        Places in a row, of T bodies.
    sizes : ndarray (k, T, r)
        What is taken off distances, in one or several ways.
    when : ndarray (T,), optional
        Times of the bodies, where obstacles may move.
    """
    middles = runs[:, :, runs.shape[2] // 2]
    reach = np.linalg.norm(runs - middles[:, :, None], axis=-1).max(axis=2)
    most, least = np.full(sizes.shape[:2], np.inf), list[Floats | None]()
    for each in obstacles:
        obstacle, seen = seen_from(each, middles, when)
        away = measure(obstacle, seen.reshape(-1, 3)).reshape(middles.shape[:2])
        most = np.minimum(most, (away - sizes).min(axis=2, initial=np.inf))
        known = not isinstance(obstacle, Field) and not (isinstance(obstacle, Grid) and not obstacle.occupancy)
        least.append(away - reach if known else None)
    slack = UNSURE * (np.abs(np.where(np.isfinite(most), most, 0.0)) + np.abs(runs).max(initial=0.0))
    for i, low in enumerate(least):
        near = np.ones(middles.shape[:2], np.bool_)
        if low is not None:
            near = (low - sizes <= (most + slack)[:, :, None]).any(axis=0)
        if near.any():
            yield i, near


def _steps(grid: Grid, points: Floats) -> Floats:
    """How far points (m, 3) are from the first of a grid, along its axes."""
    away: Floats = points - grid.origin
    return away if np.array_equal(grid.axes, np.eye(3)) else away @ grid.axes


def at_most(obstacle: Obstacle, points: Floats) -> Floats:
    """Upper bound (m,) of the signed distance of points (m, 3): the same, but for a grid of distances and a function.

    Infinite where what is known bounds nothing.
    """
    if isinstance(obstacle, Grid) and not obstacle.occupancy:
        return most_to_grid(obstacle, _steps(obstacle, points))
    distance = measure(obstacle, points)
    return _where_known(obstacle, distance, distance) if isinstance(obstacle, Field) else distance


def _where_known(source: Grid | Field, values: Floats, bounds: Floats) -> Floats:
    """The `bounds` where values are known to be distances, or a place is in the obstacle; else infinite."""
    known = (values <= 0.0) | (values < source.exact_below)
    return np.where(known, bounds, np.inf)


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
    return (points - obstacle.start) @ span / (square if square > 0.0 else 1.0)


def to_boxes(points: Floats, half: Floats) -> Floats:
    """Signed distance (m,) of points (m, 3) to a box about the origin with these half extents (3,)."""
    return _corner(np.abs(points) - half)


def _corner(excess: Floats) -> Floats:
    """Distance to where all of `excess` (m, d) are negative."""
    outside = np.linalg.norm(np.maximum(excess, 0.0), axis=-1)
    return np.asarray(np.where(outside > 0.0, outside, excess.max(axis=-1)))


def to_mesh(mesh: Mesh, points: Floats) -> Floats:
    """Signed distance (m,) of points (m, 3) to a mesh, as if the body were to stay outside."""
    corners = mesh.vertices[mesh.faces]
    centers = 0.5 * (corners.min(axis=1) + corners.max(axis=1))
    reach = np.linalg.norm(corners - centers[:, None], axis=-1).max(axis=1)

    def exact(point: Indices, triangle: Indices) -> Floats:
        return to_triangles(corners[triangle], points[point])

    distances = least_distances(points, centers, reach, exact)
    if not mesh.watertight:
        return np.asarray(distances - mesh.half_thickness)
    return np.asarray(distances * _signs(corners, points, distances) - mesh.half_thickness)


def to_triangles(corners: Floats, points: Floats) -> Floats:
    """Distance (m,) of every point (m, 3) to the triangle (m, 3, 3) in the same row."""
    corners = np.ascontiguousarray(np.moveaxis(corners, 0, -1))  # (3, 3, m): sums over the last axis are slow
    sides = np.roll(corners, -1, axis=0) - corners
    away = points.T - corners
    along = ((away * sides).sum(axis=1) / np.maximum((sides**2).sum(axis=1), 1e-300)).clip(0.0, 1.0)
    to_edge = np.sqrt(((away - along[:, None] * sides) ** 2).sum(axis=1).min(axis=0))
    normal = np.cross(sides[0], sides[1], axis=0)
    normal /= np.maximum(np.sqrt((normal**2).sum(axis=0)), 1e-300)
    above = (np.cross(sides, away, axis=1) * normal).sum(axis=1) >= 0.0
    to_plane = np.abs((away[0] * normal).sum(axis=0))
    return np.asarray(np.where(above.all(axis=0), to_plane, to_edge))


def _signs(corners: Floats, points: Floats, distances: Floats) -> Floats:
    """Signs (m,): -1 inside. Between neighbours nearer to each other than to the surface it cannot change."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=-1)
    fresh = np.ones(len(points), bool)
    fresh[1:] = steps >= np.maximum(distances[1:], distances[:-1])
    inside = winding_numbers(points[fresh], corners) > 0.5
    return np.where(inside, -1.0, 1.0)[np.cumsum(fresh) - 1]


def to_cloud(cloud: PointCloud, points: Floats) -> Floats:
    """Signed distance (m,) of points (m, 3) to the nearest ball of a cloud."""

    def exact(point: Indices, ball: Indices) -> Floats:
        gaps: Floats = np.linalg.norm(points[point] - cloud.points[ball], axis=-1)
        return gaps - cloud.radii[ball]

    return least_distances(points, cloud.points, cloud.radii, exact)


def to_grid(grid: Grid, points: Floats) -> Floats:
    """Signed distance (m,) to the nearest cube of an occupancy grid; of distances what they prove.

    `points` (m, 3) are counted from the first one of the grid, along its axes.
    """
    return _to_cubes(grid, points) if grid.occupancy else _proved(grid, points)


def to_field(field: Field, points: Floats) -> Floats:
    """Ask the function itself for points (m, 3)."""
    return evaluate(field.function, points)


def _to_cubes(grid: Grid, points: Floats) -> Floats:
    centers = grid.spacing * np.argwhere(grid.values).astype(np.float64)
    if not len(centers):
        return np.full(len(points), np.inf)
    half = 0.5 * grid.spacing

    def exact(point: Indices, cube: Indices) -> Floats:
        return to_boxes(points[point] - centers[cube], np.full(3, half))

    return least_distances(points, centers, np.full(len(centers), math.sqrt(3.0) * half), exact)


def _proved(grid: Grid, points: Floats) -> Floats:
    """Largest of `value - distance` (m,) over the corners of the cell of each point, or of the nearest cell.

    No distance function with these samples has less there.
    """
    values, gaps = _corners(grid, points)
    return (values - gaps).max(axis=0)


def most_to_grid(grid: Grid, points: Floats) -> Floats:
    """Least of `value + distance` (m,) over the same corners: no distance function with these samples has more."""
    values, gaps = _corners(grid, points)
    return _where_known(grid, values, values + gaps).min(axis=0)


def _corners(grid: Grid, points: Floats) -> tuple[Floats, Floats]:
    """Values (8, m) at the corners of the cell of each point, or of the nearest cell, and their distances from it."""
    cell = np.floor(points / grid.spacing).astype(np.int64)
    first = cell.clip(0, np.array(grid.values.shape) - 2)
    at = np.stack([first + corner for corner in np.ndindex(2, 2, 2)])
    gaps: Floats = np.linalg.norm(points - grid.spacing * at, axis=-1)
    return grid.values[tuple(np.moveaxis(at, -1, 0))], gaps


Indices = NDArray[np.intp]
Exact = Callable[[Indices, Indices], Floats]

PAIRS = 2**18
"""Pairs of a point and a thing that are looked at together."""

BLOCK = 2**20
"""Neighbours that are asked for together."""


def least_distances(points: Floats, centers: Floats, reach: Floats, exact: Exact) -> Floats:
    """Least of the distances from each point to all things.

    Parameters
    ----------
    points : ndarray (m, 3)
    centers, reach : ndarray (k, 3), (k,)
        Balls that hold the things.
    exact : callable
        From indices of points (i,) and of things (i,) to their distances (i,), signed or not.

    Returns
    -------
    ndarray (m,)
    """
    from scipy.spatial import cKDTree  # noqa: PLC0415

    best = np.full(len(points), np.inf)
    everyone = np.arange(len(points))
    sizes = [(members, cKDTree(centers[members])) for members in _alike(reach)]
    for members, tree in sizes:
        best = np.minimum(best, exact(everyone, members[tree.query(points)[1]]))
    for members, tree in sizes:
        within = np.maximum(best + float(reach[members].max()), 0.0) * (1.0 + 1e-12)
        counts = np.asarray(tree.query_ball_point(points, within, return_length=True))
        for block in _blocks(counts):
            lists = tree.query_ball_point(points[block], within[block])
            point = np.repeat(block, counts[block])
            thing = members[np.concatenate([np.asarray(entry, np.intp) for entry in lists])]
            for first in range(0, len(point), PAIRS):
                part = slice(first, first + PAIRS)
                np.minimum.at(best, point[part], exact(point[part], thing[part]))
    return best


def _alike(reach: Floats) -> list[Indices]:
    """Things whose balls differ in size by at most a factor of two, so that a large one does not widen every search."""
    exponents = np.frexp(reach)[1]
    return [np.flatnonzero(exponents == e) for e in np.unique(exponents)]


def _blocks(counts: Indices) -> Iterator[Indices]:
    """Split points that have this many neighbours into blocks that have about `BLOCK` together."""
    number = np.cumsum(counts) // BLOCK
    for n in np.unique(number):
        yield np.flatnonzero(number == n)
