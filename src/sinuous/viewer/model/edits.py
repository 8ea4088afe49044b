"""Obstacles that are moved, resized or made new by hand."""

import math
from functools import singledispatch
from typing import Any

import numpy as np

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.poses import pose
from sinuous.scene.clouds.point_cloud import PointCloud
from sinuous.scene.extents import box_of
from sinuous.scene.grids.grid import Grid
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Primitive, Sphere
from sinuous.writing.plain import pose_arguments

KINDS = ("sphere", "box", "capsule", "cylinder", "half_space")
"""What can be added by hand."""


def place_of(obstacle: Obstacle) -> Floats | None:
    """Pose (4, 4) that an obstacle is grasped at; None for one that cannot be moved."""
    if isinstance(obstacle, Primitive):
        return pose(obstacle.frame.center, rotation=obstacle.frame.rotation)
    if isinstance(obstacle, Grid) and obstacle.source is not None:
        return None
    box = box_of(obstacle) if isinstance(obstacle, Mesh | PointCloud | Grid) else None
    return None if box is None else pose(box.mean(axis=0))


def is_quick(obstacle: Obstacle) -> bool:
    """Whether a moved one is ready at once; others wait until they are let go."""
    return isinstance(obstacle, Primitive)


@singledispatch
def carried(obstacle: Obstacle, motion: Floats) -> Obstacle:
    """Return the obstacle after a rigid motion (4, 4).

    One that was read from a file is read from there again, to the last digit as a saved problem will have it.

    Raises
    ------
    InputError
        When it cannot be moved, or its file cannot be read any more.
    """
    raise InputError("obstacle", "cannot be moved", obstacle, "an obstacle that is no function and no grid from a file")


def _there(motion: Floats, point: Floats) -> Floats:
    moved: Floats = motion[:3, :3] @ point + motion[:3, 3]
    return moved


@carried.register
def _(obstacle: Sphere, motion: Floats) -> Obstacle:
    return Sphere(_there(motion, obstacle.center), obstacle.radius, obstacle.inside, obstacle.name)


@carried.register
def _(obstacle: Box, motion: Floats) -> Obstacle:
    turned = motion[:3, :3] @ obstacle.rotation
    return Box(_there(motion, obstacle.center), obstacle.size, turned, obstacle.inside, obstacle.name)


@carried.register
def _(obstacle: Capsule, motion: Floats) -> Obstacle:
    return Capsule(_there(motion, obstacle.start), _there(motion, obstacle.end), obstacle.radius, obstacle.name)


@carried.register
def _(obstacle: Cylinder, motion: Floats) -> Obstacle:
    ends = _there(motion, obstacle.start), _there(motion, obstacle.end)
    return Cylinder(*ends, obstacle.radius, obstacle.inside, obstacle.name)


@carried.register
def _(obstacle: HalfSpace, motion: Floats) -> Obstacle:
    return HalfSpace(_there(motion, obstacle.point), motion[:3, :3] @ obstacle.normal, obstacle.name)


@carried.register
def _(obstacle: Grid, motion: Floats) -> Obstacle:
    if obstacle.source is not None:
        raise InputError("obstacle", "cannot be moved", obstacle, "a grid that is not from a file")
    return Grid(obstacle.values, obstacle.origin + motion[:3, 3], obstacle.spacing, name=obstacle.name)


@carried.register
def _(obstacle: Mesh, motion: Floats) -> Obstacle:
    if _alone(obstacle):
        return _read_again(obstacle, motion)
    walls: dict[str, Any] = {"thickness": obstacle.thickness, "inside": obstacle.inside, "name": obstacle.name}
    return Mesh(_all_there(motion, obstacle.vertices), obstacle.faces, **walls)


@carried.register
def _(obstacle: PointCloud, motion: Floats) -> Obstacle:
    if _alone(obstacle):
        return _read_again(obstacle, motion)
    return PointCloud(_all_there(motion, obstacle.points), obstacle.radii, name=obstacle.name)


def _alone(obstacle: Mesh | PointCloud) -> bool:
    return obstacle.source is not None and obstacle.source.parts == 1


def _read_again(obstacle: Mesh | PointCloud, motion: Floats) -> Obstacle:
    source = obstacle.source
    assert source is not None
    arguments: dict[str, Any] = dict(source.arguments)
    before = pose(arguments.pop("position", None), rotation=arguments.pop("rotation", None))
    placed = {**arguments, **(pose_arguments(motion @ before) or {})}
    return type(obstacle).load(source.file, name=obstacle.name, **placed)


def _all_there(motion: Floats, points: Floats) -> Floats:
    moved: Floats = points @ motion[:3, :3].T + motion[:3, 3]
    return moved


def sizes_of(obstacle: Obstacle) -> dict[str, float]:
    """Lengths that can be changed by hand, by their names."""
    if isinstance(obstacle, Box):
        return dict(zip(("size x", "size y", "size z"), obstacle.size.tolist(), strict=True))
    if isinstance(obstacle, Sphere):
        return {"radius": obstacle.radius}
    if isinstance(obstacle, Capsule | Cylinder):
        return {"radius": obstacle.radius, "length": math.dist(obstacle.start, obstacle.end)}
    return {}


def resized(obstacle: Obstacle, **sizes: float) -> Obstacle:
    """Return the obstacle about the same center with other lengths, called as in `sizes_of` with `_` for spaces.

    Raises
    ------
    InputError
        When a length is none.
    """
    own = {key.replace(" ", "_"): value for key, value in sizes_of(obstacle).items()} | sizes
    if isinstance(obstacle, Box):
        size = [own["size_x"], own["size_y"], own["size_z"]]
        return Box(obstacle.center, size, obstacle.rotation, obstacle.inside, obstacle.name)
    if isinstance(obstacle, Sphere):
        return Sphere(obstacle.center, own["radius"], obstacle.inside, obstacle.name)
    if isinstance(obstacle, Capsule | Cylinder):
        center, rotation, _ = obstacle.frame
        half = 0.5 * own["length"] * rotation[:, 2]
        ends = center - half, center + half
        if isinstance(obstacle, Capsule):
            return Capsule(*ends, own["radius"], obstacle.name)
        return Cylinder(*ends, own["radius"], obstacle.inside, obstacle.name)
    raise InputError("obstacle", "has no size of its own", obstacle, "a sphere, box, capsule or cylinder")


def made(kind: str, center: Floats, size: float) -> Obstacle:
    """Return a new obstacle at a place (3,), about as large as `size`.

    Raises
    ------
    InputError
        When there is no such kind.
    """
    along = np.array([0.0, 0.0, 0.5 * size])
    if kind == "sphere":
        return Sphere(center, 0.5 * size)
    if kind == "box":
        return Box(center, np.full(3, size))
    if kind == "capsule":
        return Capsule(center - along, center + along, 0.25 * size)
    if kind == "cylinder":
        return Cylinder(center - along, center + along, 0.25 * size)
    if kind == "half_space":
        return HalfSpace(center, (0.0, 0.0, 1.0))
    raise InputError("kind", "", kind, "one of " + ", ".join(KINDS))
