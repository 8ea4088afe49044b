"""Open pipes: the base in one mouth or outside, the target beyond the other."""

import math

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.shapes import Curve, curve_of, draw_shape
from benchmarks.places.parts.surfaces import WALL, open_tube, solid
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.places.traps.boxes import channel
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot

RINGS = 9
"""Rings of a mesh along one segment."""

BEHIND = (0.0, 2.0)
"""How far a pipe goes on behind the base, in radii of the body."""

STRAIGHT, CLOSED = 0.35, 0.3
"""Share of open pipes that are straight, and of those that are closed behind the base."""

REACH = (0.3, 0.75)
"""Of a shape, how much a bent pipe that begins at the base encloses."""

GUIDE = (1.1, 1.35)
"""Inner radius of a guide tube, in radii of the body."""


def open_pipe(width: float, robot: Robot, rng: Generator) -> Sketch:
    """Put the base into one mouth of a pipe of `width` times the radius of the body, bent or straight."""
    straight = _first(robot, rng) if rng.random() < STRAIGHT else 0
    q, curve = _shape(robot, width, range(straight), rng)
    end = straight * RINGS if straight else round(rng.uniform(*REACH) * (len(curve.poses) - 1))
    return _piped(robot, q, curve.poses[: end + 1], width, rng)


def guide_tube(robot: Robot, rng: Generator) -> Sketch:
    """Put the base into a straight tube that hardly leaves room; the shape bends beyond its mouth."""
    straight, width = _first(robot, rng), rng.uniform(*GUIDE)
    q, curve = _shape(robot, width, range(straight), rng)
    return _piped(robot, q, curve.poses[: straight * RINGS + 1], width, rng)


def pipe_between(width: float, robot: Robot, rng: Generator) -> Sketch:
    """Put a pipe, bent or straight, around the middle of the shape: base and target are outside."""
    n = len(robot)
    first = int(rng.integers(1, n - 1))
    straight = range(first, first + 1 + (n - first) // 3) if rng.random() < STRAIGHT else range(0)
    q, curve = _shape(robot, width, straight, rng)
    last = len(curve.poses) - 1
    begin, end = straight.start * RINGS, min(straight.stop * RINGS, last)
    if not straight:
        begin, end = (round(share * last) for share in (rng.uniform(0.15, 0.4), rng.uniform(0.6, 0.85)))
    radius = max(robot.radii)
    wall = open_tube(curve.poses[begin : end + 1], width * radius, (width + WALL) * radius)
    return sketch_of(robot, [solid(wall, "pipe")], q, rng)


def open_channel(width: float, robot: Robot, rng: Generator) -> Sketch:
    """Put the base into a straight channel of four boxes."""
    straight = _first(robot, rng)
    q, curve = _shape(robot, math.sqrt(2.0) * width, range(straight), rng)
    poses = backwards(curve.poses[: straight * RINGS + 1], max(robot.radii), rng)
    length = float(np.linalg.norm(poses[-1, :3, 3] - poses[0, :3, 3]))
    radius = max(robot.radii)
    return sketch_of(robot, channel(poses[0], width * radius, length, WALL * radius), q, rng)


def _first(robot: Robot, rng: Generator) -> int:
    """How many segments from the base lie straight: some must be left to bend."""
    stage = robot.segments[0].max_bend == 0.0
    return int(stage + rng.integers(0 if stage else 1, max(2, (len(robot) - stage) // 2)))


def _shape(robot: Robot, width: float, straight: range, rng: Generator) -> tuple[Floats, Curve]:
    q = draw_shape(robot, 2.1 * (width + WALL) * max(robot.radii), rng, straight=straight)
    return q, curve_of(robot, q, RINGS)


def backwards(poses: Floats, radius: float, rng: Generator) -> Floats:
    """Begin a little behind the first of the frames (m, 4, 4)."""
    start = poses[:1].copy()
    start[0, :3, 3] -= radius * rng.uniform(*BEHIND) * start[0, :3, 2]
    return np.concatenate([start, poses])


def _piped(robot: Robot, q: Floats, poses: Floats, width: float, rng: Generator) -> Sketch:
    """Put a wall around frames (m, 4, 4) that begin at the base."""
    radius = max(robot.radii)
    enclosed = backwards(poses, radius, rng)
    closed = rng.random() < CLOSED
    if closed:
        enclosed[0, :3, 3] = poses[0, :3, 3] - 1.2 * radius * poses[0, :3, 2]
    wall = open_tube(enclosed, width * radius, (width + WALL) * radius, bottom=closed)
    return sketch_of(robot, [solid(wall, "pipe")], q, rng)
