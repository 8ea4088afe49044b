"""A duct that branches: one branch leads to the target, the others are dead ends."""

import math

import igl
import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import arc, curve_of, draw_shape, lengthened
from benchmarks.places.parts.surfaces import Faces, Surface, joined, solid
from benchmarks.places.place import Sketch
from sinuous.checks import Floats

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

CUBE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
"""Corners of a cell, in the order that marching cubes takes them."""


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
    wall = joined([_around(tree, OUTSIDE * radius, cell), _around(tree, INSIDE * radius, cell).turned])
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


def _around(tree: cKDTree, distance: float, cell: float) -> Surface:
    """Return the surface at a distance from all points of a tree, by marching cubes in the cells that it meets."""
    places = np.asarray(tree.data)
    reach = math.ceil(distance / cell) + 2
    block = np.stack(np.meshgrid(*[np.arange(-reach, reach)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    origin = places.min(axis=0) - (reach + 1) * cell
    coarse = np.unique(((places - origin) / (2.0 * cell)).astype(np.int64), axis=0) * np.int64(2)
    cells = _distinct((coarse[:, None] + block).reshape(-1, 3))
    corners = cells[:, None] + CUBE
    nodes, numbers = np.unique(_key(corners.reshape(-1, 3)), return_inverse=True)
    points = origin + cell * _from_key(nodes)
    values = tree.query(points)[0] - distance
    numbers = numbers.reshape(-1, 8)
    mixed = np.ptp(np.sign(values)[numbers], axis=1) > 0.0
    vertices, faces, _ = igl.marching_cubes(values, points, numbers[mixed])
    return Surface(vertices, faces)


SPAN = 1 << 20


def _key(cells: Faces) -> Faces:
    """One number for every triple of whole numbers."""
    key: Faces = (cells[:, 0] * SPAN + cells[:, 1]) * SPAN + cells[:, 2]
    return key


def _from_key(key: Faces) -> Faces:
    return np.stack([key // SPAN // SPAN, key // SPAN % SPAN, key % SPAN], axis=-1)


def _distinct(cells: Faces) -> Faces:
    return _from_key(np.unique(_key(cells)))
