"""Surfaces of obstacles, and points on those that have none."""

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.display.surface import Surface, box, capsule, cylinder, sphere, square
from sinuous.scene.grids import Field, Grid
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Primitive, Sphere
from sinuous.scene.point_cloud import PointCloud

AROUND = 32
"""Faces around what is round."""

PIECES = 12
"""Faces along an edge or a wall: pictures sort faces by the distance of their middles, so that none may be long."""

MOST_POINTS = 20_000
"""Points of an obstacle that are drawn; of more, evenly spread ones are."""

Dotted = PointCloud | Grid | Field
"""Obstacles that are drawn as points."""


def obstacle_surface(
    obstacle: Obstacle, middle: Floats, span: float, around: int = AROUND, pieces: int = PIECES
) -> Surface:
    """Return the surface of an obstacle in the world. It faces the side where the body may be.

    Parameters
    ----------
    obstacle : Primitive or Mesh
        A mesh that is not watertight has no inside; its faces face as they are given.
    middle : ndarray (3,)
        A half-space has no end: a square is drawn where it is nearest to this place.
    span : float
        Side of that square.
    around : int
        Faces around what is round.
    pieces : int
        Faces along an edge of a box or square, and along the wall of a cylinder or capsule.
    """
    if isinstance(obstacle, Mesh):
        surface = Surface(obstacle.vertices, obstacle.faces[:, [0, 1, 2, 2]])
        return surface.turned() if obstacle.inside else surface
    if isinstance(obstacle, HalfSpace):
        near = middle - (middle - obstacle.point) @ obstacle.normal * obstacle.normal
        return square(0.5 * span, pieces).moved(obstacle.frame.rotation, near)
    if not isinstance(obstacle, Primitive):
        raise NotImplementedError(f"no picture of {type(obstacle).__name__}")
    center, rotation, half = obstacle.frame
    match obstacle:
        case Sphere(radius=radius):
            local = sphere(radius, around)
        case Box():
            local = box(half, pieces)
        case Capsule(radius=radius):
            local = capsule(radius, float(half[2]), around, pieces)
        case Cylinder(radius=radius):
            local = cylinder(radius, float(half[2]), around, pieces)
        case _:
            raise NotImplementedError(f"no picture of {type(obstacle).__name__}")
    surface = local.moved(rotation, center)
    return surface.turned() if getattr(obstacle, "inside", False) else surface


def dots(obstacle: Dotted) -> Floats:
    """Points (m, 3) of a cloud, or on the surface of a grid or field."""
    if isinstance(obstacle, PointCloud):
        points = obstacle.points
    elif isinstance(obstacle, Grid) and obstacle.occupancy:
        points = obstacle.points(np.argwhere(_outermost(obstacle.values.astype(np.bool_))))
    else:
        points = obstacle.points(_crossings(obstacle.values))
    return points[:: -(-len(points) // MOST_POINTS)] if len(points) > MOST_POINTS else points


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
