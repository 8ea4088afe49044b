"""Points on the surfaces of clouds, grids and fields, for pictures."""

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.scene.clouds.point_cloud import PointCloud
from sinuous.scene.grids.field import Field
from sinuous.scene.grids.grid import Grid

MOST = 20_000
"""Points in a picture; of more, evenly spread ones are drawn."""

Dotted = PointCloud | Grid | Field


def dots(obstacle: Dotted) -> Floats:
    """Points (m, 3) of a cloud, or on the surface of a grid or field."""
    if isinstance(obstacle, PointCloud):
        points = obstacle.points
    elif isinstance(obstacle, Grid) and obstacle.occupancy:
        points = obstacle.points(np.argwhere(_outermost(obstacle.values.astype(np.bool_))))
    else:
        points = obstacle.points(_crossings(obstacle.values))
    return points[:: -(-len(points) // MOST)] if len(points) > MOST else points


def _outermost(occupied: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Occupied cells that have a free one at one of their six faces."""
    around = np.pad(occupied, 1)
    buried = np.ones_like(occupied)
    for axis in range(3):
        for step in (-1, 1):
            buried &= np.roll(around, step, axis)[1:-1, 1:-1, 1:-1]
    return np.asarray(occupied & ~buried)


def _crossings(values: Floats) -> Floats:
    """Places (m, 3), in steps of the grid, where neighbours along an axis differ in sign, by linear interpolation."""
    found = []
    for axis in range(3):
        near = np.delete(values, -1, axis)
        rise = np.diff(values, axis=axis)
        at = np.argwhere((near > 0.0) != (near + rise > 0.0))
        places = at.astype(np.float64)
        places[:, axis] -= near[tuple(at.T)] / rise[tuple(at.T)]
        found.append(places)
    return np.concatenate(found)
