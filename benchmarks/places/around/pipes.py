"""A curved pipe that is closed at both ends: there is one way, and it is as narrow as is said."""

from numpy.random import Generator

from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import curve_of, draw_shape, lengthened
from benchmarks.places.parts.surfaces import WALL, hollow, solid
from benchmarks.places.place import Sketch

RINGS = 9
"""Rings of a mesh along one segment."""


def pipe(width: float, seed: int, rng: Generator) -> Sketch:
    """Wall in the hidden shape with a pipe of `width` times the radius of the body."""
    robot = robot_of(seed, rng)
    radius = min(robot.radii)
    outside = (width + WALL) * radius
    q = draw_shape(robot, 2.1 * outside, rng)
    poses = lengthened(curve_of(robot, q, RINGS).poses, width * radius)
    return Sketch(robot, [solid(hollow(poses, width * radius, outside), "pipe")], q)
