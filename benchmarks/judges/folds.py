"""How far is the body from itself? Asked of all pairs of very many places.

Two places count when they are at least pi times the larger of their radii apart along the backbone: the definition of
self-collision (thickness of a tube; Cantarella, Kusner & Sullivan 2002).
"""

import math

import numpy as np

from benchmarks.judges.kinematics import body_points
from sinuous.checks import Floats
from sinuous.robot.robot import Robot

SAMPLES = 60
"""Places looked at in a segment."""


def least_self_clearance(robot: Robot, q: Floats) -> Floats:
    """Return the least distance (m,) of configurations (m, n, 3) from themselves; infinite where no places count."""
    points, along = body_points(robot, q, SAMPLES)
    radii = np.repeat(robot.radii, SAMPLES + 1)
    larger, both = np.maximum(radii[:, None], radii), radii[:, None] + radii
    return np.array([_least(p.reshape(-1, 3), s.ravel(), larger, both) for p, s in zip(points, along, strict=True)])


def _least(points: Floats, along: Floats, larger: Floats, both: Floats) -> float:
    squares = (points**2).sum(axis=1)
    gaps = np.sqrt(np.maximum(squares[:, None] + squares - 2.0 * points @ points.T, 0.0)) - both
    counts = np.abs(along[:, None] - along) >= math.pi * larger
    return float(np.where(counts, gaps, math.inf).min())
