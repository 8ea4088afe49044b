"""Plates across the way, each with one hole, to be threaded in a row."""

import math

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import Curve, curve_of, draw_shape
from benchmarks.places.parts.surfaces import plate, solid
from benchmarks.places.place import Sketch
from sinuous.base.checks import Floats
from sinuous.scene.meshes.mesh import Mesh

FEWEST, MOST = 2, 6
AHEAD = 0.3
"""Least cosine of the angle between the hidden shape and where it begins: plates across a coil would have to be small.
"""

HOLE, THICKNESS = 1.5, 0.5
SMALLEST, LARGEST = 12.0, 16.0
"""Half the edge of a plate: the largest one that does not cut the hidden shape elsewhere.

All lengths in radii of the body.
"""


def plates(seed: int, rng: Generator) -> Sketch | None:
    """Put two to six plates across the hidden shape, evenly along it but for a little."""
    robot = robot_of(seed, rng)
    radius = min(robot.radii)
    q = draw_shape(robot, 4.0 * radius, rng, AHEAD)
    curve = curve_of(robot, q, 40)
    count = int(rng.integers(FEWEST, MOST + 1))
    shares = 0.2 + 0.7 * (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count
    found: list[Mesh] = []
    for share in shares:
        pose = curve.poses[round(share * (len(curve.poses) - 1))]
        half = largest_half(curve, pose, radius)
        if half < SMALLEST * radius:
            return None
        surface = plate(pose, half, HOLE * radius, THICKNESS * radius)
        found.append(solid(surface, f"plate {len(found) + 1}"))
    return Sketch(robot, found, q)


def largest_half(curve: Curve, pose: Floats, radius: float) -> float:
    """Return half the edge of the plate that leaves 1.5 radii to all of the curve that does not go through its hole."""
    local = (curve.points - pose[:3, 3]) @ pose[:3, :3]
    across = np.abs(local[:, :2]).max(axis=1)
    near = (np.abs(local[:, 2]) < 2.0 * radius) & (across > HOLE * radius)
    return min(LARGEST * radius, float(across[near].min(initial=math.inf)) - 2.0 * radius)
