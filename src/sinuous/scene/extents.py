"""How large obstacles are."""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.scene.grids import Field, Grid
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.moving import Moving
from sinuous.scene.obstacles import HalfSpace, Obstacle, Primitive
from sinuous.scene.point_cloud import PointCloud


def box_of(obstacle: Obstacle) -> Floats | None:
    """Return opposite corners (2, 3) of a box, along the axes of the world, around an obstacle; `None`: it has no end.

    Of a `Field` and of a `Grid` of distances it is the box that their samples fill.
    """
    if isinstance(obstacle, Moving):
        return _on_the_way(obstacle)
    if isinstance(obstacle, Primitive):
        center, rotation, half, rounding = obstacle.frame
        reach = np.abs(rotation) @ half + rounding
        return None if isinstance(obstacle, HalfSpace) else np.array([center - reach, center + reach])
    if isinstance(obstacle, Mesh):
        return _around(obstacle.vertices[np.unique(obstacle.faces)], 0.5 * obstacle.thickness)
    if isinstance(obstacle, PointCloud):
        return _around(obstacle.points, obstacle.radii[:, None])
    if isinstance(obstacle, Grid | Field):
        return _of_samples(obstacle)
    raise NotImplementedError(f"no extents of {type(obstacle).__name__}")


def _on_the_way(moving: Moving) -> Floats | None:
    """Box around an obstacle at all of its times, and so all the way, but where it turns far from where it is."""
    boxes = [box_of(moving.at(t)) for t in moving.times.tolist()]
    return None if boxes[0] is None else _around(np.concatenate([box for box in boxes if box is not None]), 0.0)


def _of_samples(obstacle: Grid | Field) -> Floats | None:
    if isinstance(obstacle, Grid) and obstacle.occupancy:
        occupied, half = np.argwhere(obstacle.values), 0.5 * obstacle.spacing * np.abs(obstacle.axes).sum(axis=1)
        return _around(obstacle.points(occupied), half) if len(occupied) else None
    last = np.array(obstacle.values.shape) - 1
    return _around(obstacle.points(last * np.array(list(np.ndindex(2, 2, 2)))), 0.0)


def _around(points: Floats, reach: Floats | float) -> Floats:
    """Opposite corners (2, 3) of the box around balls or boxes with these middles (m, 3)."""
    return np.stack([(points - reach).min(axis=0), (points + reach).max(axis=0)])
