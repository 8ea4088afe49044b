"""Where a mesh or a cloud would have to give way to a body: the part of it that the body overlaps."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.measures.obstacles import to_triangles
from sinuous.model.robot import Robot
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.point_cloud import PointCloud

PLACES = 64
"""Places of each segment that a body is seen at."""

MOST_PAIRS = 4_000_000
"""Most pairs of triangles and places that are held against each other together."""


class GivenWay(NamedTuple):
    """An obstacle without what a body overlaps.

    Attributes
    ----------
    rest : Obstacle
    center : ndarray (3,)
        The place of the body that is deepest in what is missing.
    radius : float
        How far from there what is missing goes.
    """

    rest: Obstacle
    center: Floats
    radius: float


def give_way(robot: Robot, q: Floats, obstacle: Obstacle, demanded: float) -> GivenWay | None:
    """Take out of a mesh or a cloud what the body in a configuration (n, 3) overlaps; `None` where nothing is left.

    `demanded`: how far the body has to stay from obstacles.
    """
    if not isinstance(obstacle, Mesh | PointCloud) or obstacle.inside:
        return None
    places = robot.backbone(q, PLACES)
    radii = np.append(np.repeat(robot.radii, PLACES), robot.radii[-1]) + demanded
    radii = radii + 0.5 * float(np.linalg.norm(np.diff(places, axis=0), axis=1).max())
    if isinstance(obstacle, PointCloud):
        gaps, ends = _of_cloud(obstacle, places, radii)
    else:
        gaps, ends = _of_mesh(obstacle, places, radii)
    hit = gaps.min(axis=1) <= 0.0
    if not hit.any() or hit.all():
        return None
    center = places[int(gaps[hit].min(axis=0).argmin())]
    radius = float(np.linalg.norm(ends[hit] - center, axis=-1).max())
    if isinstance(obstacle, PointCloud):
        return GivenWay(PointCloud(obstacle.points[~hit], obstacle.radii[~hit], name=obstacle.name), center, radius)
    thick = 2.0 * obstacle.half_thickness
    rest = Mesh(obstacle.vertices, obstacle.faces[~hit], thickness=thick, name=obstacle.name)
    return GivenWay(rest, center, radius)


def _of_cloud(cloud: PointCloud, places: Floats, radii: Floats) -> tuple[Floats, Floats]:
    """Gaps (m, k) between balls and places, and the centers (m, 1, 3) of the balls."""
    apart = np.linalg.norm(cloud.points[:, None] - places, axis=-1)
    return apart - radii - cloud.radii[:, None], cloud.points[:, None]


def _of_mesh(mesh: Mesh, places: Floats, radii: Floats) -> tuple[Floats, Floats]:
    """Gaps (m, k) between triangles and places, and the corners (m, 3, 3) of the triangles."""
    corners = mesh.vertices[mesh.faces]
    gaps = np.empty((len(corners), len(places)))
    size = max(1, MOST_PAIRS // len(places))
    for first in range(0, len(corners), size):
        some: NDArray[np.float64] = corners[first : first + size]
        which, where = np.indices((len(some), len(places))).reshape(2, -1)
        gaps[first : first + size] = to_triangles(some[which], places[where]).reshape(len(some), len(places))
    return gaps - radii - mesh.half_thickness, corners
