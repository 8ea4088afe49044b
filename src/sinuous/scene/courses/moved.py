"""An obstacle of any kind, moved by a pose; what was computed of it once serves wherever it is."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sinuous.checks import Floats
from sinuous.scene.grids.field import Field
from sinuous.scene.grids.grid import Grid
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Sphere


def moved(obstacle: Obstacle, pose: Floats) -> Obstacle:
    """Return an obstacle of the same name, each place x of which lies at `pose` (4, 4) times x."""
    turn, shift, name = pose[:3, :3], pose[:3, 3], obstacle.name
    match obstacle:
        case Sphere():
            there: Obstacle = Sphere(turn @ obstacle.center + shift, obstacle.radius, obstacle.inside, name)
        case Box():
            center, rotation = turn @ obstacle.center + shift, turn @ obstacle.rotation
            there = Box(center, obstacle.size, rotation, obstacle.inside, name)
        case Capsule():
            there = Capsule(turn @ obstacle.start + shift, turn @ obstacle.end + shift, obstacle.radius, name)
        case Cylinder():
            ends = turn @ obstacle.start + shift, turn @ obstacle.end + shift
            there = Cylinder(*ends, obstacle.radius, obstacle.inside, name)
        case HalfSpace():
            there = HalfSpace(turn @ obstacle.point + shift, turn @ obstacle.normal, name)
        case Grid():
            there = obstacle.placed(pose, origin=_there(pose, obstacle.origin), axes=turn @ obstacle.axes)
        case Field():
            corners = {"low": _there(pose, obstacle.low), "high": _there(pose, obstacle.high)}
            function = Elsewhere(obstacle.function, pose)
            there = obstacle.placed(pose, function=function, axes=turn @ obstacle.axes, **corners)
        case _:
            there = obstacle.placed(pose)
    return there


def _there(pose: Floats, point: Floats) -> Floats:
    place: Floats = pose[:3, :3] @ point + pose[:3, 3]
    place.flags.writeable = False
    return place


@dataclass(frozen=True, eq=False)
class Elsewhere:
    """A signed distance, moved by a pose.

    Attributes
    ----------
    function : callable
        From points (m, 3) to distances (m,).
    pose : ndarray (4, 4)
    """

    function: Callable[[Floats], Any]
    pose: Floats

    def __call__(self, points: Floats) -> Any:
        """Distances (m,) of points (m, 3) in the world."""
        local = (np.asarray(points) - self.pose[:3, 3]) @ self.pose[:3, :3]
        return self.function(local)
