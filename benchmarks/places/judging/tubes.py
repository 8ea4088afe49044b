"""Tubes of other shapes: a helix, a tree that tapers, a pipe with throats. The base stands in a mouth or before it."""

import math

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

from benchmarks.places.parts.marching import around
from benchmarks.places.parts.shapes import arc, curve_of, draw_shape, keeps_from_itself, lengthened
from benchmarks.places.parts.surfaces import WALL, open_tube, solid, widening_tube
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.places.traps.pipes import backwards
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot

FRAMES = 60
"""Least number of frames along a shape that a wall is made on."""

WIDTH = (1.3, 1.8)
"""Inner radius of a helix, in radii of the body."""

BEFORE, WITHIN = (0.01, 0.07), 0.3
"""How far before the mouth the base stands, of the length; and the share of bases that stand in the mouth."""

BEYOND = (0.6, 0.95)
"""Where a tube ends that the tip leaves, of the length."""

COILED, TORSION = (0.4, 0.9), (0.3, 1.2)
"""Bends of a coil, of the largest; and how far its bending plane turns from segment to segment, rad."""

TRUNK, LEAF = (2.0, 2.6), (1.3, 1.6)
"""Inner radius of a tree at its mouth and at the tip, in radii of the body."""

TWIGS, TWIG = (2, 4), (8.0, 20.0)
"""How many twigs leave the way to the tip, and their length in radii of the body."""

TWIG_WIDTH, TWIG_BEND = 0.8, (0.7, 1.6)
"""Inner radius of a twig, of that of the branch it leaves; and the angle by which it bends away, rad."""

STEP, CELL = 0.25, 0.6
"""Distance of points on the axes of a tree, and edge of the cells of its walls, in radii of the body."""

THROATS, THROAT, CHAMBER = (1, 3), (1.25, 1.5), (1.8, 3.0)
"""How many throats a pipe has; and its inner radius there and between them, in radii of the body."""


def helix(robot: Robot, rng: Generator) -> Sketch | None:
    """Coil the shape into a pipe that is open at both ends; the tip is beyond it."""
    radius, width = max(robot.radii), rng.uniform(*WIDTH)
    q = _coil(robot, rng)
    curve = curve_of(robot, q, _samples(robot))
    if not keeps_from_itself(curve, 2.1 * (width + WALL) * radius):
        return None
    poses = _piped(curve.poses, radius, rng)
    return sketch_of(robot, [solid(open_tube(poses, width * radius, (width + WALL) * radius), "helix")], q, rng)


def stenosis(robot: Robot, rng: Generator) -> Sketch:
    """Draw the shape through a pipe that is narrow in a few places and wide between them."""
    radius = max(robot.radii)
    wide = rng.uniform(*CHAMBER)
    q = draw_shape(robot, 2.1 * (wide + WALL) * radius, rng)
    poses = _piped(curve_of(robot, q, _samples(robot)).poses, radius, rng)
    share, count = np.linspace(0.0, 1.0, len(poses)), int(rng.integers(THROATS[0], THROATS[1] + 1))
    inside = np.full(len(poses), wide)
    for center in (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count:
        throat = rng.uniform(*THROAT)
        inside = np.minimum(inside, throat + (wide - throat) * (1.0 - np.exp(-(((share - center) * 6.0 * count) ** 2))))
    wall = widening_tube(poses, radius * inside, radius * (inside + WALL))
    return sketch_of(robot, [solid(wall, "vessel")], q, rng)


def bronchi(robot: Robot, rng: Generator) -> Sketch | None:
    """Lead the shape from the mouth of a tree of tubes, which taper, into one of its leaves."""
    radius, (begin, end) = max(robot.radii), (rng.uniform(*TRUNK), rng.uniform(*LEAF))
    q = draw_shape(robot, 2.2 * (begin + WALL) * radius, rng)
    samples = math.ceil(q[:, 2].max() / (STEP * radius))
    poses = lengthened(curve_of(robot, q, samples).poses, end * radius)
    axes, widths = [poses[:, :3, 3]], [radius * np.linspace(begin, end, len(poses))]
    for _ in range(int(rng.integers(TWIGS[0], TWIGS[1] + 1))):
        at = int(rng.uniform(0.1, 0.8) * len(poses))
        width = TWIG_WIDTH * widths[0][at]
        twig = _twig(poses[at], radius, rng)
        far = np.linalg.norm(twig - twig[0], axis=1) > 3.2 * (begin + WALL) * radius
        gaps = np.asarray(cKDTree(np.concatenate(axes)).query(twig)[0])
        if far.any() and gaps[far].min() > 2.1 * (begin + WALL) * radius:
            axes.append(twig)
            widths.append(np.full(len(twig), width))
    if len(axes) == 1:
        return None
    points, inside = np.concatenate(axes), np.concatenate(widths)
    mouth = poses[0, :3, 3] - np.linspace(0.0, (begin + 2.0) * radius, 20)[:, None] * poses[0, :3, 2]
    hollow, room = np.concatenate([points, mouth]), np.concatenate([inside, np.full(20, begin * radius)])
    walls, hollows = cKDTree(points), cKDTree(hollow)

    def signed(places: Floats) -> Floats:
        (outer, i), (inner, j) = walls.query(places), hollows.query(places)
        return np.asarray(np.maximum(outer - inside[i] - WALL * radius, room[j] - inner))

    surface = around(points, (begin + WALL) * radius, CELL * radius, signed)
    return sketch_of(robot, [solid(surface, "tree")], q, rng)


def _samples(robot: Robot) -> int:
    return max(9, math.ceil(FRAMES / len(robot)))


def _coil(robot: Robot, rng: Generator) -> Floats:
    """A configuration (n, 3) whose bends are alike and whose bending plane turns evenly."""
    share, turn, plane = rng.uniform(*COILED), rng.uniform(*TORSION) * rng.choice([-1.0, 1.0]), rng.uniform(0.0, 6.28)
    rows = []
    for k, segment in enumerate(robot.segments):
        low, high = segment.length
        angle, bend = plane + k * turn, share * segment.max_bend
        rows.append([bend * math.cos(angle), bend * math.sin(angle), rng.uniform(max(low, 0.3 * high), high)])
    return np.array(rows)


def _piped(poses: Floats, radius: float, rng: Generator) -> Floats:
    """The frames (m, 4, 4) of a pipe around a shape: from its mouth, at the base or ahead of it, to where it ends."""
    last = len(poses) - 1
    end = round(rng.uniform(*BEYOND) * last) + 1
    if rng.random() < WITHIN:
        return backwards(poses[:end], radius, rng)
    return poses[max(1, round(rng.uniform(*BEFORE) * last)) : end]


def _twig(at: Floats, radius: float, rng: Generator) -> Floats:
    """Points (m, 3) of an arc that leaves the way at a frame (4, 4)."""
    plane, bend, length = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(*TWIG_BEND), radius * rng.uniform(*TWIG)
    coordinates = np.array([bend * math.cos(plane), bend * math.sin(plane), length])
    points: Floats = arc(at, coordinates, math.ceil(length / (STEP * radius)))[:, :3, 3]
    return points
