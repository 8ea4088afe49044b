"""The distance to any obstacle."""

import numpy as np

from sinuous.checks import Floats
from sinuous.measures.primitives import to_primitive
from sinuous.measures.samples import most_to_grid, to_cloud, to_field, to_grid
from sinuous.measures.triangles import to_mesh
from sinuous.scene.clouds.point_cloud import PointCloud
from sinuous.scene.grids.field import Field
from sinuous.scene.grids.grid import Grid
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Obstacle, Primitive


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
    return np.asarray(-distance if getattr(obstacle, "inside", False) else distance)


def _steps(grid: Grid, points: Floats) -> Floats:
    """How far points (m, 3) are from the first of a grid, along its axes."""
    away: Floats = points - grid.origin
    return away if np.array_equal(grid.axes, np.eye(3)) else away @ grid.axes


def at_most(obstacle: Obstacle, points: Floats) -> Floats:
    """Upper bound (m,) of the signed distance of points (m, 3): the same, but for a grid of distances."""
    if isinstance(obstacle, Grid) and not obstacle.occupancy:
        return most_to_grid(obstacle, _steps(obstacle, points))
    return measure(obstacle, points)
