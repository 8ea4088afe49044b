"""A curved pipe that is closed at both ends: there is one way, and it is as narrow as is said."""

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import arc, curve_of, draw_shape
from benchmarks.places.parts.surfaces import Surface, joined, tube
from benchmarks.places.place import Sketch
from sinuous.checks import Floats
from sinuous.scene.meshes.mesh import Mesh

WALL = 0.8
"""Thickness of walls, in radii of the body."""

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


def lengthened(poses: Floats, by: float) -> Floats:
    """Go on straight beyond the last of frames (m, 4, 4), so that the tip has room."""
    return np.concatenate([poses, arc(poses[-1], np.array([0.0, 0.0, by]), 2)[1:]])


def hollow(poses: Floats, inside: float, outside: float) -> Surface:
    """Return the wall between two radii around a curve, closed by half a ball at each end."""
    return joined([tube(poses, outside), tube(poses, inside).turned])


def solid(surface: Surface, name: str) -> Mesh:
    """Return the obstacle that a closed surface bounds."""
    return Mesh(surface.vertices, surface.faces, name=name)
