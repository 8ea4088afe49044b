"""How far is the body from itself? Asked of all pairs of very many places.

Two places count when they are at least pi times the larger of their radii apart along the backbone: the definition of
self-collision (thickness of a tube; Cantarella, Kusner & Sullivan 2002).
"""

import math

import numpy as np
from scipy.spatial.distance import cdist

from benchmarks.judges.kinematics import body_points
from sinuous.checks import Floats
from sinuous.robot.robot import Robot

SAMPLES = 60
"""Places looked at in a segment."""


def least_self_clearance(robot: Robot, q: Floats) -> Floats:
    """Return the least distance (m,) of configurations (m, n, 3) from themselves; infinite where no places count.

    Pairs of segments are looked at by how near the balls about their places are, as long as one may be nearer than what
    was found.
    """
    points, along = body_points(robot, q, SAMPLES)
    return np.array([_least(*one, np.array(robot.radii)) for one in zip(points, along, strict=True)])


def _least(points: Floats, along: Floats, radii: Floats) -> float:
    """The same of one configuration: places (n, s, 3), and how far along they are (n, s)."""
    centers = points.mean(axis=1)
    reach = np.linalg.norm(points - centers[:, None], axis=-1).max(axis=1) + radii
    i, j = np.triu_indices(len(radii))
    gaps = np.linalg.norm(centers[i] - centers[j], axis=-1) - reach[i] - reach[j]
    least = math.inf
    for k in np.argsort(gaps):
        if gaps[k] >= least:
            break
        a, b = i[k], j[k]
        apart = cdist(points[a], points[b]) - radii[a] - radii[b]
        counts = np.abs(along[a][:, None] - along[b]) >= math.pi * max(radii[a], radii[b])
        least = min(least, float(apart.min(initial=math.inf, where=counts)))
    return least
