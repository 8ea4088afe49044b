"""What people change by hand: obstacles that are moved, resized or made new, rates, and other parts of a job."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.documents import pose_arguments
from sinuous.base.errors import InputError
from sinuous.model.poses import pose
from sinuous.model.rates import KEYS, Kept, Rates, least, scaled
from sinuous.motion.job import Job
from sinuous.scene.grids import Grid
from sinuous.scene.mesh import Mesh
from sinuous.scene.moving import moved
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Primitive, Sphere
from sinuous.scene.point_cloud import PointCloud

MADE: dict[str, Callable[[Floats, float, Floats], Obstacle]] = {
    "sphere": lambda center, size, up: Sphere(center, 0.5 * size),
    "box": lambda center, size, up: Box(center, np.full(3, size)),
    "capsule": lambda center, size, up: Capsule(center - up, center + up, 0.25 * size),
    "cylinder": lambda center, size, up: Cylinder(center - up, center + up, 0.25 * size),
    "half_space": lambda center, size, up: HalfSpace(center, (0.0, 0.0, 1.0)),
}
"""What can be added by hand: of a center (3,), a size, and the vector (0, 0, size / 2)."""

KINDS = tuple(MADE)


def pose_of(obstacle: Obstacle) -> Floats | None:
    """Pose (4, 4) that an obstacle is grasped at; None for one that cannot be moved."""
    if isinstance(obstacle, Primitive):
        return pose(obstacle.frame.center, rotation=obstacle.frame.rotation)
    if isinstance(obstacle, Grid) and obstacle.source is not None:
        return None
    box = obstacle._box if isinstance(obstacle, Mesh | PointCloud | Grid) else None
    return None if box is None else pose(box.mean(axis=0))


def is_quick(obstacle: Obstacle) -> bool:
    """Whether a moved one is ready at once; others wait until they are let go."""
    return isinstance(obstacle, Primitive)


def move_obstacle(obstacle: Obstacle, motion: Floats) -> Obstacle:
    """Return the obstacle after a rigid motion (4, 4); a grid is translated alone.

    One that was read from a file is read from there again, to the last digit as a saved problem will have it.

    Raises
    ------
    InputError
        When it cannot be moved, or its file cannot be read any more.
    """
    if pose_of(obstacle) is None:
        expected = "an obstacle that stands still and is no function and no grid from a file"
        raise InputError("obstacle", "cannot be moved", obstacle, expected)
    if isinstance(obstacle, Mesh | PointCloud) and obstacle.source is not None and obstacle.source.parts == 1:
        return _read_again(obstacle, motion)
    return moved(obstacle, pose(motion[:3, 3]) if isinstance(obstacle, Grid) else motion)


def _read_again(obstacle: Mesh | PointCloud, motion: Floats) -> Obstacle:
    source = obstacle.source
    assert source is not None
    arguments: dict[str, Any] = dict(source.arguments)
    before = pose(arguments.pop("position", None), rotation=arguments.pop("rotation", None))
    placed = {**arguments, **(pose_arguments(motion @ before) or {})}
    return type(obstacle).load(source.file, name=obstacle.name, **placed)


def sizes_of(obstacle: Obstacle) -> dict[str, float]:
    """Lengths that can be changed by hand, by their names."""
    if isinstance(obstacle, Box):
        return dict(zip(("size x", "size y", "size z"), obstacle.size.tolist(), strict=True))
    if isinstance(obstacle, Sphere):
        return {"radius": obstacle.radius}
    if isinstance(obstacle, Capsule | Cylinder):
        return {"radius": obstacle.radius, "length": math.dist(obstacle.start, obstacle.end)}
    return {}


def resize_obstacle(obstacle: Obstacle, **sizes: float) -> Obstacle:
    """Return the obstacle about the same center with other lengths, called as in `sizes_of` with `_` for spaces.

    Raises
    ------
    InputError
        When a length is none.
    """
    own = {key.replace(" ", "_"): value for key, value in sizes_of(obstacle).items()} | sizes
    if isinstance(obstacle, Box):
        return obstacle._changed({"size": [own["size_x"], own["size_y"], own["size_z"]]})
    if isinstance(obstacle, Sphere):
        return obstacle._changed({"radius": own["radius"]})
    if isinstance(obstacle, Capsule | Cylinder):
        center, rotation, *_ = obstacle.frame
        half = 0.5 * own["length"] * rotation[:, 2]
        return obstacle._changed({"start": center - half, "end": center + half, "radius": own["radius"]})
    raise InputError("obstacle", "has no size of its own", obstacle, "a sphere, box, capsule or cylinder")


def make_obstacle(kind: str, center: Floats, size: float) -> Obstacle:
    """Return a new obstacle at a place (3,), about as large as `size`.

    Raises
    ------
    InputError
        When there is no such kind.
    """
    return MADE[checks.choice("kind", kind, KINDS)](center, size, np.array([0.0, 0.0, 0.5 * size]))


def least_rates(rates: Rates | None) -> Floats:
    """The least speeds of bends, lengths and actuators (3,) that rates allow at most; 0 without a limit."""
    return np.array([0.0 if rates is None else least(getattr(rates, key)) for key in KEYS[:3]])


def with_least(rates: Rates, wanted: Floats) -> tuple[Kept, Kept, Kept]:
    """Bounds of bends, lengths and actuators of which these (3,) are the least; 0: no limit."""
    bend, length, actuator = wanted.tolist()
    return _with(rates.bend, bend), _with(rates.length, length), _with(rates.actuator, actuator)


def _with(own: Kept, most: float) -> Kept:
    if own is None or isinstance(own, float) or not most:
        return most or None
    return own if most == least(own) else scaled(own, most / least(own))


def change_job(job: Job, **parts: Any) -> Job:
    """Return a job with other parts: arguments of `Job`."""
    kept = "scene", "tolerance", "start", "prefer", "rates", "times", "reconfigure", "workspace", "goal", "file"
    own: dict[str, Any] = {key: getattr(job, key) for key in kept}
    if job.waypoints:
        own["path" if job.is_path else "target"] = job.waypoints if job.is_path else job.waypoints[0]
    return Job(parts.pop("robot", job.robot), **{**own, **parts})
