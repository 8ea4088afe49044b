"""How far is the body from itself? Asked of all pairs of very many places.

Two places count, where the radius is the same from one to the other, when they are at least pi radii apart along the
backbone (thickness of a tube; Cantarella, Kusner & Sullivan 2002); where it changes, unless each is ahead of the other.
"""

import math

import numpy as np
from scipy.spatial.distance import cdist

from benchmarks.judges.kinematics import body_points
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot

SAMPLES = 60
"""Places looked at in a segment."""

DOUBT = 0.02
"""Cosine to which it is told from differences of places whether one lies ahead of another."""


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
        if (radii[a : b + 1] == radii[a]).all():
            counts = np.abs(along[a][:, None] - along[b]) >= math.pi * radii[a]
        else:
            across = points[b] - points[a][:, None]
            ahead = [
                np.einsum("ijk,ik->ij", across, _tangents(points[a])),
                np.einsum("ijk,jk->ij", across, _tangents(points[b])),
            ]
            counts = np.minimum(*ahead) < -DOUBT * np.linalg.norm(across, axis=-1)
        least = min(least, float(apart.min(initial=math.inf, where=counts)))
    return least


def _tangents(points: Floats) -> Floats:
    """Unit tangents (s, 3) at places (s, 3) of a segment; zero where it has no length."""
    slopes = np.gradient(points, axis=0)
    result: Floats = slopes / np.maximum(np.linalg.norm(slopes, axis=-1, keepdims=True), 1e-300)
    return result
