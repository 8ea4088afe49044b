"""Distances to what is known at points: clouds, grids, functions."""

import math

import numpy as np

from sinuous.checks import Floats
from sinuous.measures.nearest import Indices, least_distances
from sinuous.measures.primitives import to_boxes
from sinuous.scene.clouds.point_cloud import PointCloud
from sinuous.scene.grids.field import Field, evaluate
from sinuous.scene.grids.grid import Grid


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
    result: Floats = (values - gaps).max(axis=0)
    return result


def most_to_grid(grid: Grid, points: Floats) -> Floats:
    """Least of `value + distance` (m,) over the same corners: no distance function with these samples has more."""
    values, gaps = _corners(grid, points)
    result: Floats = (values + gaps).min(axis=0)
    return result


def _corners(grid: Grid, points: Floats) -> tuple[Floats, Floats]:
    """Values (8, m) at the corners of the cell of each point, or of the nearest cell, and their distances from it."""
    cell = np.floor(points / grid.spacing).astype(np.int64)
    first = cell.clip(0, np.array(grid.values.shape) - 2)
    at = np.stack([first + corner for corner in np.ndindex(2, 2, 2)])
    gaps: Floats = np.linalg.norm(points - grid.spacing * at, axis=-1)
    return grid.values[tuple(np.moveaxis(at, -1, 0))], gaps
