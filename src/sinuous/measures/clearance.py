"""How far the body, and single places, are from the obstacles of a scene."""

import math
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.measures.body import body_places
from sinuous.measures.obstacles import at_most, measure
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot


class Nearest(NamedTuple):
    """The least distance to obstacles, and where it is.

    Attributes
    ----------
    distance : float
        Infinite without obstacles.
    segment : int or None
        Segment of the body, 1 = first.
    obstacle : str or None
        Name of the obstacle.
    """

    distance: float
    segment: int | None
    obstacle: str | None


def least_clearance(robot: Robot, scene: Snapshot, q: Floats, ends: Floats) -> Nearest:
    """Least clearance over sampled places of the body beyond the mount, in configuration `q` (n, 3).

    `ends` (n + 1, 4, 4) are the poses of the base and of the ends of all segments.
    """
    least = Nearest(math.inf, None, None)
    if len(scene) == 0:
        return least
    places, segments = body_places(robot, q, ends)
    radii = np.array(robot.radii)[segments]
    for i, obstacle in enumerate(scene.obstacles):
        clearances = measure(obstacle, places) - radii
        if clearances.min(initial=math.inf) < least.distance:
            nearest = int(clearances.argmin())
            least = Nearest(float(clearances[nearest]), int(segments[nearest]) + 1, scene.name(i))
    return least


def room_at(place: Floats, scene: Snapshot) -> Nearest:
    """Upper bound of the distance of a place (3,) to the obstacles, and the obstacle that gives it."""
    distances = [float(at_most(obstacle, place[None])[0]) for obstacle in scene.obstacles]
    nearest = int(np.argmin(distances))
    return Nearest(distances[nearest], None, scene.name(nearest))
