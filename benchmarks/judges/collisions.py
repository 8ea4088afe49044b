"""Does the body touch anything? Asked of python-fcl, with the body as balls so close that little is left between.

The balls are inside the body, so an overlap that is found is one. What fcl computes between a ball and a sphere, box,
capsule or cylinder is a closed form, exact to rounding. Of a mesh it sees the triangles, not the solid, and of clouds,
grids and fields nothing: there `benchmarks.judges.clearances` is asked as well.
"""

import math
from collections.abc import Sequence
from functools import cached_property, lru_cache, partial, singledispatch

import fcl
import numpy as np

import sinuous as sn
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.kinematics import body_points
from sinuous.base.checks import Floats
from sinuous.model.poses import least_rotation
from sinuous.scene.obstacles import Obstacle, Primitive

FEWEST_SAMPLES = 50
"""Intervals between balls, a segment."""

MOST_SAMPLES = 400

GRACE = 1e-9
"""By how much of its length a robot is made thinner, so that rounding accuses nobody."""


class Body:
    """The body of a robot in one scene, as fcl sees both.

    Parameters
    ----------
    robot : Robot
    scene : Scene
        Of obstacles to stay out of, and boxes and meshes to stay within.
    thorough : bool
        Whether to measure clearances from exact shapes, too, at very many places.
    """

    def __init__(self, robot: sn.Robot, scene: sn.Scene, thorough: bool = False) -> None:
        self._robot = robot
        for obstacle in scene.obstacles:
            if isinstance(obstacle, sn.Sphere | sn.Cylinder):
                _outside_only(obstacle)
        self._obstacles = scene.obstacles
        rich = [o for o in scene.obstacles if thorough or not isinstance(o, Primitive)]
        self._clearances = Clearances(robot, sn.Scene(rich)) if rich else None
        self._grace = GRACE * robot.mean_length
        self._samples = _samples_of(robot)

    @cached_property
    def _balls(self) -> list[list[fcl.CollisionObject]]:
        radii = np.array(self._robot.radii) - self._grace
        return [
            [fcl.CollisionObject(fcl.Sphere(max(radius, 0.0))) for _ in range(self._samples + 1)] for radius in radii
        ]

    @cached_property
    def _scene(self) -> fcl.DynamicAABBTreeCollisionManager:
        size = 10.0 * _reach(self._robot, self._obstacles)
        return _manager(
            [fcl.CollisionObject(*shape) for obstacle in self._obstacles for shape in _shapes(obstacle, size)]
        )

    def clearance(self, q: Floats, enough: float = math.inf) -> Floats:
        """Return the least clearance (m,) of configurations (m, n, 3), see `Clearances.least`.

        Without `thorough` that from what is not an exact shape.
        """
        return np.full(len(q), math.inf) if self._clearances is None else self._clearances.least(q, enough)

    def touches(self, q: Floats) -> list[bool]:
        """Say for every configuration (m, n, 3) whether fcl finds an overlap."""
        points, along = body_points(self._robot, q, self._samples)
        return [self._overlaps(*one) for one in zip(points, along, strict=True)]

    def overlaps(self, q: Floats) -> list[bool]:
        """Say for every configuration (m, n, 3) whether its body overlaps an obstacle."""
        within = self.clearance(q, 0.0) < -self._grace
        return [bool(one or other) for one, other in zip(self.touches(q), within, strict=True)]

    def _overlaps(self, points: Floats, along: Floats) -> bool:
        exposed = along >= self._robot.mount
        balls = []
        for k, row in enumerate(self._balls):
            for ball, point, counts in zip(row, points[k], exposed[k], strict=True):
                if counts:
                    ball.setTranslation(point)
                    balls.append(ball)
        answer = fcl.CollisionData()
        self._scene.collide(_manager(balls), answer, fcl.defaultCollisionCallback)
        return bool(answer.result.is_collision)


body_of = lru_cache(maxsize=2)(partial(Body, thorough=True))
"""A thorough one for a robot and a scene: whoever looks at a place again finds it prepared."""


def _manager(objects: list[fcl.CollisionObject]) -> fcl.DynamicAABBTreeCollisionManager:
    manager = fcl.DynamicAABBTreeCollisionManager()
    manager.registerObjects(objects)
    manager.setup()
    return manager


def _samples_of(robot: sn.Robot) -> int:
    """So many that neighbouring balls are at most half a radius apart, within reason."""
    wanted = max(
        2.0 * segment.length[1] / radius if radius > 0.0 else MOST_SAMPLES
        for segment, radius in zip(robot.segments, robot.radii, strict=True)
    )
    return int(np.clip(np.ceil(wanted), FEWEST_SAMPLES, MOST_SAMPLES))


def _reach(robot: sn.Robot, obstacles: Sequence[Obstacle]) -> float:
    """Return a length that neither the robot nor a room around it exceeds."""
    longest = sum(segment.length[1] for segment in robot.segments) + max(robot.radii)
    rooms = [float(np.linalg.norm(o.size)) for o in obstacles if isinstance(o, sn.Box) and o.inside]
    return max([longest, *rooms])


Shape = tuple[fcl.CollisionGeometry, fcl.Transform]


@singledispatch
def _shapes(obstacle: Obstacle, size: float) -> list[Shape]:
    """Return the solids, in fcl, that an obstacle consists of; walls are `size` thick and twice as wide."""
    raise NotImplementedError(f"the judge does not know {type(obstacle).__name__}")


def _outside_only(obstacle: sn.Sphere | sn.Cylinder) -> None:
    if obstacle.inside:
        raise NotImplementedError(f"the judge does not know how to be inside a {type(obstacle).__name__}")


@_shapes.register
def _sphere(obstacle: sn.Sphere, size: float) -> list[Shape]:
    return [(fcl.Sphere(obstacle.radius), fcl.Transform(obstacle.center))]


@_shapes.register
def _box(obstacle: sn.Box, size: float) -> list[Shape]:
    if not obstacle.inside:
        return [(fcl.Box(*obstacle.size), fcl.Transform(obstacle.rotation, obstacle.center))]
    axes = [*obstacle.rotation.T, *-obstacle.rotation.T]
    halves = [*(0.5 * obstacle.size), *(0.5 * obstacle.size)]
    return [_wall(obstacle.center + half * axis, -axis, size) for axis, half in zip(axes, halves, strict=True)]


@_shapes.register
def _capsule(obstacle: sn.Capsule, size: float) -> list[Shape]:
    length, place = _along(obstacle.start, obstacle.end)
    return [(fcl.Capsule(obstacle.radius, length), place)]


@_shapes.register
def _cylinder(obstacle: sn.Cylinder, size: float) -> list[Shape]:
    length, place = _along(obstacle.start, obstacle.end)
    return [(fcl.Cylinder(obstacle.radius, length), place)]


@_shapes.register
def _half_space(obstacle: sn.HalfSpace, size: float) -> list[Shape]:
    return [_wall(obstacle.point, obstacle.normal, size)]


@_shapes.register
def _mesh(obstacle: sn.Mesh, size: float) -> list[Shape]:
    model = fcl.BVHModel()
    model.beginModel(len(obstacle.vertices), len(obstacle.faces))
    model.addSubModel(obstacle.vertices, obstacle.faces)
    model.endModel()
    return [(model, fcl.Transform())]


@_shapes.register(sn.PointCloud)
@_shapes.register(sn.Grid)
@_shapes.register(sn.Field)
def _left_to_others(obstacle: Obstacle, size: float) -> list[Shape]:
    return []


def _wall(point: Floats, normal: Floats, size: float) -> Shape:
    """Return a box with a face on a plane, so large that to the robot it is a half-space.

    The tree of a manager cannot hold the infinite `fcl.Halfspace`: it crashes.
    """
    return fcl.Box(2.0 * size, 2.0 * size, size), fcl.Transform(least_rotation(normal), point - 0.5 * size * normal)


def _along(start: Floats, end: Floats) -> tuple[float, fcl.Transform]:
    length = float(np.linalg.norm(end - start))
    rotation = least_rotation((end - start) / length) if length > 0.0 else np.eye(3)
    return length, fcl.Transform(rotation, 0.5 * (start + end))
