"""Many balls, most of them close to the hidden shape."""

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import Curve, curve_of, draw_shape
from benchmarks.places.place import Sketch
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Sphere

LEAST_RADIUS, MOST_RADIUS = 1.5, 5.0
LEAST_GAP, MOST_GAP = 0.15, 10.0
"""Range of the clearance that a ball beside the hidden shape leaves; cubes of an even draw, so that most are close.

All four in radii of the body.
"""


def spheres(count: int, seed: int, rng: Generator) -> Sketch:
    """Put `count` balls beside the hidden shape, each beside a place of its own."""
    robot = robot_of(seed, rng)
    radius = min(robot.radii)
    q = draw_shape(robot, 3.0 * radius, rng)
    curve = curve_of(robot, q, 20)
    found: list[Sphere] = []
    while len(found) < count:
        ball = _beside(robot, curve, rng)
        if np.linalg.norm(curve.points - ball.center, axis=-1).min() >= ball.radius + (1.0 + LEAST_GAP) * radius:
            found.append(ball)
    return Sketch(robot, found, q)


def _beside(robot: Robot, curve: Curve, rng: Generator) -> Sphere:
    unit = min(robot.radii)
    size = unit * rng.uniform(LEAST_RADIUS, MOST_RADIUS)
    gap = unit * (LEAST_GAP + (MOST_GAP - LEAST_GAP) * rng.random() ** 3)
    place = curve.points[rng.integers(len(curve.points))]
    return Sphere(place + (size + unit + gap) * _direction(rng), size)


def _direction(rng: Generator) -> Floats:
    drawn = rng.normal(size=3)
    direction: Floats = drawn / np.linalg.norm(drawn)
    return direction
