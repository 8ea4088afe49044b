"""A duct that branches: one branch leads to the target, the others are dead ends."""

import math

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

from benchmarks.places.parts.marching import around
from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import arc, curve_of, draw_shape, lengthened
from benchmarks.places.parts.surfaces import Surface, joined, solid
from benchmarks.places.place import Sketch
from sinuous.base.checks import Floats

INSIDE, OUTSIDE = 1.7, 2.6
"""Radii of the wall, in radii of the body."""

FEWEST, MOST = 2, 4
BRANCH = (10.0, 20.0)
"""Length of a dead end, in radii of the body."""

BEND = (0.6, 1.8)
"""Of a dead end, away from the right way, rad."""

CELL = 1.0
"""Of the grid that the wall is made on, in radii of the body."""

STEP = 0.25
"""Between points of the curves that the wall is made around, in radii of the body."""

TRIES = 30


def duct(seed: int, rng: Generator) -> Sketch | None:
    """Wall in the hidden shape and some dead ends that leave it."""
    robot = robot_of(seed, rng)
    radius = min(robot.radii)
    q = draw_shape(robot, 2.1 * OUTSIDE * radius, rng)
    samples = math.ceil(max(q[:, 2]) / (STEP * radius))
    main = lengthened(curve_of(robot, q, samples).poses, INSIDE * radius)
    ends = _dead_ends(main, radius, rng)
    if len(ends) < FEWEST:
        return None
    tree = cKDTree(np.concatenate([main[:, :3, 3], *ends]))
    cell = CELL * radius
    wall = joined([_at(tree, OUTSIDE * radius, cell), _at(tree, INSIDE * radius, cell).turned])
    return Sketch(robot, [solid(wall, "duct")], q)


def _dead_ends(main: Floats, radius: float, rng: Generator) -> list[Floats]:
    """Points (m, 3) of each dead end; they touch neither each other nor the right way but where they leave it."""
    wanted, found = int(rng.integers(FEWEST, MOST + 1)), list[Floats]()
    for _ in range(TRIES):
        if len(found) == wanted:
            break
        at = int(rng.uniform(0.15, 0.85) * len(main))
        branch = _branch(main, at, radius, rng)
        gaps = np.asarray(cKDTree(np.concatenate([main[:, :3, 3], *found])).query(branch)[0])
        gone = np.linalg.norm(branch - branch[0], axis=-1) > 3.0 * OUTSIDE * radius
        if gone.any() and gaps[gone.argmax() :].min() > 2.1 * OUTSIDE * radius:
            found.append(branch)
    return found


def _branch(main: Floats, at: int, radius: float, rng: Generator) -> Floats:
    """One arc that leaves the way at frame `at`, to any side but the one that the way bends to."""
    ahead = main[min(at + 20, len(main) - 1), :3, 3] - main[at, :3, 3]
    side = main[at, :3, :2].T @ ahead
    plane = math.atan2(-side[1], -side[0]) + rng.uniform(-1.0, 1.0)
    bend, length = rng.uniform(*BEND), radius * rng.uniform(*BRANCH)
    coordinates = np.array([bend * math.cos(plane), bend * math.sin(plane), length])
    points: Floats = arc(main[at], coordinates, math.ceil(length / (STEP * radius)))[:, :3, 3]
    return points


def _at(tree: cKDTree, distance: float, cell: float) -> Surface:
    """Return the surface at a distance from all points of a tree."""
    return around(np.asarray(tree.data), distance, cell, lambda points: np.asarray(tree.query(points)[0]) - distance)
