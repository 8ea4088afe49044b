"""How far is the body from everything? Distances that are independent of the kernels, at very many places.

Meshes are asked of libigl (a tree of boxes for the distance, winding numbers for the side: whoever is inside a solid
overlaps it, though the body may touch no triangle), clouds of SciPy's k-d tree, exact shapes of plain NumPy, kind by
kind.
"""

import math
from functools import cache, lru_cache, partial, singledispatch

import igl
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.judges.kinematics import Backbones, Indices, body_places
from benchmarks.judges.primitives import Distance, distances_to
from benchmarks.judges.self_collision import places_of
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle, Primitive

MOST_PLACES = 5_000
"""Places that are looked at in one go."""

TOGETHER = 64
"""Configurations that are looked at in one go."""

GRACE = 1e-9
"""What rounding may make of a clearance, in robot lengths."""

COARSE, FINEST = 4, 4096
"""Intervals of a segment to begin with, and the finest that they are halved to."""


class Clearances:
    """A robot in a scene, prepared to measure many configurations.

    Parameters
    ----------
    robot : Robot
    scene : Scene
    """

    def __init__(self, robot: sn.Robot, scene: sn.Scene) -> None:
        self._robot = robot
        self._measures = distances_among(scene, robot.mean_length + float(np.abs(robot.base[:3, 3]).max()))

    def least(self, q: Floats, enough: float = math.inf) -> Floats:
        """Return the least clearance (m,) of configurations (m, n, 3) at `FINEST` places of every segment.

        Distances change by no more than the place does: so intervals are halved as long as they can hold less than what
        was seen, and less than `enough`. What is more than that is an upper bound only. Of arms with joints links and
        segments are sampled: what is seen is never below the true.
        """
        if self._robot.joints:
            return self._sampled(q)
        parts = [self._least(q[i : i + TOGETHER], enough) for i in range(0, len(q), TOGETHER)]
        return np.concatenate([np.empty(0), *parts])

    def _sampled(self, q: Floats) -> Floats:
        least = np.full(len(q), math.inf)
        for _, points, radius in body_places(self._robot, q, places_of(q)):
            for measured in self._measures:
                own = measured(points.reshape(-1, 3)).reshape(points.shape[:2])
                least = np.minimum(least, own.min(axis=1) - radius)
        return least

    def _least(self, q: Floats, enough: float) -> Floats:
        m, n = q.shape[:2]
        body = Backbones.of(self._robot, q)
        shape, segment, at = (which.ravel() for which in np.indices((m, n, COARSE + 1)))
        gaps = self._gaps(body, shape, segment, at / COARSE).reshape(m, n, COARSE + 1)
        least = np.asarray(gaps.min(axis=(1, 2)))
        shape, segment, at = (which.ravel() for which in np.indices((m, n, COARSE)))
        before, after = gaps[..., :-1].ravel(), gaps[..., 1:].ravel()
        count = COARSE
        while True:
            low = _lowest(before, after, q[shape, segment, 2] / count)
            going = low < np.minimum(least, enough)[shape]
            if count == FINEST or not going.any():
                return least
            shape, segment, at, before, after = (each[going] for each in (shape, segment, at, before, after))
            middle = self._gaps(body, shape, segment, (at + 0.5) / count)
            np.minimum.at(least, shape, middle)
            shape, segment, at, count = np.repeat(shape, 2), np.repeat(segment, 2), np.repeat(2 * at, 2), 2 * count
            at[1::2] += 1
            before, after = np.stack([before, middle], axis=1).ravel(), np.stack([middle, after], axis=1).ravel()

    def _gaps(self, body: Backbones, shape: Indices, segment: Indices, fractions: Floats) -> Floats:
        """Clearance (k,) of places, by configuration and segment; infinite in the mount, which nothing concerns."""
        points, along = body.places(shape, segment, fractions), body.q[shape, segment, 2] * fractions
        exposed = np.flatnonzero(body.before[shape, segment] + along >= self._robot.mount)
        gaps = np.full(len(points), math.inf)
        radii = np.array(self._robot.radii)[segment]
        for i in range(0, len(exposed), MOST_PLACES):
            some = exposed[i : i + MOST_PLACES]
            for measured in self._measures:
                gaps[some] = np.minimum(gaps[some], measured(points[some]) - radii[some])
        return gaps


def _lowest(before: Floats, after: Floats, lengths: Floats) -> Floats:
    """Lower bound (k,) of the clearance in intervals, from that at both ends; infinite ends are in the mount."""
    one_end = np.minimum(before, after) - lengths
    return np.where(np.isfinite(before) & np.isfinite(after), 0.5 * (before + after - lengths), one_end)


def least_clearance(robot: sn.Robot, scene: sn.Scene, q: Floats, enough: float = math.inf) -> Floats:
    """Return the least clearance (m,) of configurations (m, n, 3); see `Clearances.least`."""
    return Clearances(robot, scene).least(q, enough)


prepared = lru_cache(maxsize=2)(Clearances)
"""For a robot and a scene: whoever looks at a place again finds it prepared."""


def overlaps(robot: sn.Robot, scene: sn.Scene, q: Floats) -> NDArray[np.bool_]:
    """Say for every configuration (m, n, 3) whether its body overlaps an obstacle, by more than rounding."""
    return np.asarray(prepared(robot, scene).least(q, 0.0) < -GRACE * robot.mean_length)


def distances_among(scene: sn.Scene, size: float = math.inf) -> list[Distance]:
    """Prepare the distances to all obstacles, for points with coordinates of this size."""
    exact = [obstacle for obstacle in scene.obstacles if isinstance(obstacle, Primitive)]
    others = [obstacle for obstacle in scene.obstacles if not isinstance(obstacle, Primitive)]
    return [*distances_to(exact, size), *map(distance_of, others)]


@singledispatch
def distance_of(obstacle: Obstacle) -> Distance:
    """Prepare the distance to one obstacle."""
    raise NotImplementedError(f"the judge does not know {type(obstacle).__name__}")


@distance_of.register
def _mesh(obstacle: sn.Mesh) -> Distance:
    vertices, faces = np.array(obstacle.vertices), np.array(obstacle.faces)
    tree = igl.AABB()
    tree.init(vertices, faces)

    def unsigned(points: Floats) -> Floats:
        if len(points) == 0:
            return np.zeros(0)
        distance: Floats = np.sqrt(np.asarray(tree.squared_distance(vertices, faces, points)[0]).reshape(-1))
        return distance

    winding = cache(partial(_winding, vertices, faces))

    def signed(points: Floats) -> Floats:
        distance = unsigned(points)
        if len(points) == 0:
            return distance
        first, run = _runs(points, distance)
        numbers = np.asarray(winding().winding_number(points[first])).reshape(-1)
        return np.where((numbers[run] > 0.5) == obstacle.inside, distance, -distance)

    return signed if obstacle.watertight else lambda points: unsigned(points) - 0.5 * obstacle.thickness


def _winding(vertices: Floats, faces: Indices) -> igl.FastWindingNumberBVH:
    tree = igl.FastWindingNumberBVH()
    tree.init(vertices, faces)
    return tree


def _runs(points: Floats, distance: Floats) -> tuple[Indices, Indices]:
    """Cut points (m, 3) into runs on one side of a surface; return the first of each run, and the run of each point.

    The straight line to the next point does not meet the surface where one of the two is farther from it than they are
    from each other.
    """
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    free = np.maximum(distance[:-1], distance[1:])
    begins = np.concatenate([[True], free <= (1.0 + 1e-6) * steps])
    return np.flatnonzero(begins), np.cumsum(begins) - 1


@distance_of.register
def _cloud(obstacle: sn.PointCloud) -> Distance:
    groups = [
        (cKDTree(obstacle.points[obstacle.radii == radius]), float(radius)) for radius in np.unique(obstacle.radii)
    ]
    return lambda points: np.min([np.asarray(tree.query(points)[0]) - radius for tree, radius in groups], axis=0)


@distance_of.register
def _field(obstacle: sn.Field) -> Distance:
    return lambda points: np.asarray(obstacle.function(points), np.float64)
