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
    """Signed distance (m,) of points (m, 3) to the nearest cube of an occupancy grid; of distances what they prove."""
    return _to_cubes(grid, points) if grid.occupancy else _proved(grid, points)


def to_field(field: Field, points: Floats) -> Floats:
    """Ask the function itself for points (m, 3)."""
    return evaluate(field.function, points)


def _to_cubes(grid: Grid, points: Floats) -> Floats:
    centers = grid.origin + grid.spacing * np.argwhere(grid.values)
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
    cell = np.floor((points - grid.origin) / grid.spacing).astype(np.int64)
    first = cell.clip(0, np.array(grid.values.shape) - 2)
    best = np.full(len(points), -np.inf)
    for corner in np.ndindex(2, 2, 2):
        at = first + corner
        gap = np.linalg.norm(points - grid.origin - grid.spacing * at, axis=-1)
        best = np.maximum(best, grid.values[tuple(at.T)] - gap)
    return best
