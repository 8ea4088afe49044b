"""How large obstacles are."""

import numpy as np

from sinuous.checks import Floats
from sinuous.scene.clouds.point_cloud import PointCloud
from sinuous.scene.grids.field import Field
from sinuous.scene.grids.grid import Grid
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Capsule, HalfSpace, Obstacle, Primitive, Sphere


def box_of(obstacle: Obstacle) -> Floats | None:
    """Return opposite corners (2, 3) of a box, along the axes of the world, around an obstacle; `None`: it has no end.

    Of a `Field` and of a `Grid` of distances it is the box that their samples fill.
    """
    if isinstance(obstacle, Primitive):
        return None if isinstance(obstacle, HalfSpace) else _of_primitive(obstacle)
    if isinstance(obstacle, Mesh):
        return _around(obstacle.vertices[np.unique(obstacle.faces)], 0.5 * obstacle.thickness)
    if isinstance(obstacle, PointCloud):
        return _around(obstacle.points, obstacle.radii[:, None])
    if isinstance(obstacle, Grid | Field):
        return _of_samples(obstacle)
    raise NotImplementedError(f"no extents of {type(obstacle).__name__}")


def _of_primitive(obstacle: Primitive) -> Floats:
    if isinstance(obstacle, Sphere):
        return np.array([obstacle.center - obstacle.radius, obstacle.center + obstacle.radius])
    center, rotation, half = obstacle.frame
    reach = np.abs(rotation) @ half + (obstacle.radius if isinstance(obstacle, Capsule) else 0.0)
    return np.array([center - reach, center + reach])


def _of_samples(obstacle: Grid | Field) -> Floats | None:
    if isinstance(obstacle, Grid) and obstacle.occupancy:
        occupied = np.argwhere(obstacle.values)
        return _around(obstacle.origin + obstacle.spacing * occupied, 0.5 * obstacle.spacing) if len(occupied) else None
    last = obstacle.origin + obstacle.spacing * (np.array(obstacle.values.shape) - 1)
    return np.stack([obstacle.origin, last])


def _around(points: Floats, reach: Floats | float) -> Floats:
    """Opposite corners (2, 3) of the box around balls or boxes with these middles (m, 3)."""
    return np.stack([(points - reach).min(axis=0), (points + reach).max(axis=0)])
