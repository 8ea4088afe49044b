"""What is put around a hidden shape: balls, a pipe, plates, a drum with blades, a shelf, a duct with dead ends."""

import math
from functools import partial

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.places.parts import (
    WALL,
    Curve,
    Surface,
    about_z,
    arc,
    around,
    box_between,
    curve_of,
    draw_shape,
    hollow,
    joined,
    lengthened,
    loft,
    offshoots,
    plate,
    solid,
)
from benchmarks.places.place import Sketch
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle

LEAST_RADIUS, MOST_RADIUS = 1.5, 5.0
LEAST_GAP, MOST_GAP = 0.15, 10.0
"""Range of the clearance that a ball beside the hidden shape leaves; cubes of an even draw, so that most are close.

All four in radii of the body.
"""


def spheres(count: int, robot: sn.Robot, rng: Generator) -> Sketch:
    """Put `count` balls beside the hidden shape, each beside a place of its own."""
    radius = min(robot.radii)
    q = draw_shape(robot, 3.0 * radius, rng)
    curve = curve_of(robot, q, 20)
    found: list[sn.Sphere] = []
    while len(found) < count:
        ball = _beside(robot, curve, rng)
        if np.linalg.norm(curve.points - ball.center, axis=-1).min() >= ball.radius + (1.0 + LEAST_GAP) * radius:
            found.append(ball)
    return Sketch(robot, found, q)


def _beside(robot: sn.Robot, curve: Curve, rng: Generator) -> sn.Sphere:
    unit = min(robot.radii)
    size = unit * rng.uniform(LEAST_RADIUS, MOST_RADIUS)
    gap = unit * (LEAST_GAP + (MOST_GAP - LEAST_GAP) * rng.random() ** 3)
    place = curve.points[rng.integers(len(curve.points))]
    return sn.Sphere(place + (size + unit + gap) * _direction(rng), size)


def _direction(rng: Generator) -> Floats:
    drawn = rng.normal(size=3)
    direction: Floats = drawn / np.linalg.norm(drawn)
    return direction


RINGS = 9
"""Rings of a mesh along one segment."""


def pipe(width: float, robot: sn.Robot, rng: Generator) -> Sketch:
    """Wall in the hidden shape with a pipe of `width` times the radius of the body."""
    radius = min(robot.radii)
    outside = (width + WALL) * radius
    q = draw_shape(robot, 2.1 * outside, rng)
    poses = lengthened(curve_of(robot, q, RINGS).poses, width * radius)
    return Sketch(robot, [solid(hollow(poses, width * radius, outside), "pipe")], q)


PLATE_FEWEST, PLATE_MOST = 2, 6
AHEAD = 0.3
"""Least cosine of the angle between the hidden shape and where it begins: plates across a coil would have to be small.
"""

HOLE, PLATE_THICKNESS = 1.5, 0.5
SMALLEST, LARGEST = 12.0, 16.0
"""Half the edge of a plate: the largest one that does not cut the hidden shape elsewhere.

All lengths in radii of the body.
"""


def plates(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put two to six plates across the hidden shape, evenly along it but for a little."""
    radius = min(robot.radii)
    q = draw_shape(robot, 4.0 * radius, rng, AHEAD)
    curve = curve_of(robot, q, 40)
    count = int(rng.integers(PLATE_FEWEST, PLATE_MOST + 1))
    shares = 0.2 + 0.7 * (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count
    found: list[sn.Mesh] = []
    for share in shares:
        pose = curve.poses[round(share * (len(curve.poses) - 1))]
        half = largest_half(curve, pose, radius)
        if half < SMALLEST * radius:
            return None
        surface = plate(pose, half, HOLE * radius, PLATE_THICKNESS * radius)
        found.append(solid(surface, f"plate {len(found) + 1}"))
    return Sketch(robot, found, q)


def largest_half(curve: Curve, pose: Floats, radius: float) -> float:
    """Return half the edge of the plate that leaves 1.5 radii to all of the curve that does not go through its hole."""
    local = (curve.points - pose[:3, 3]) @ pose[:3, :3]
    across = np.abs(local[:, :2]).max(axis=1)
    near = (np.abs(local[:, 2]) < 2.0 * radius) & (across > HOLE * radius)
    return min(LARGEST * radius, float(across[near].min(initial=math.inf)) - 2.0 * radius)


GAP = (2.8, 3.6)
"""Distance of neighbouring blades, from middle to middle, at the tip."""

HEIGHT, WIDTH, HUB = (6.0, 12.0), (5.0, 9.0), (6.0, 12.0)
"""Of a blade, along the radius and along the axis; radius of the drum. All in radii of the body."""

DRUM_THICKNESS = 0.5
TWIST = (-0.25, 0.25)
"""By how much a blade turns about the radius from root to end, rad."""

DRUM_ROWS = (1, 3)
STEPS = 6
"""Pieces of a blade from root to end."""


def drum(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Stand the drum before the hidden tip, its axis in the plane that the tip bends in, and grow blades around it."""
    radius = min(robot.radii)
    q = draw_shape(robot, 4.0 * radius, rng)
    tip = curve_of(robot, q, 2).poses[-1]
    outwards = -tip[:3, 2]
    axis = tip[:3, :2] @ (q[-1, :2] / np.linalg.norm(q[-1, :2]))
    hub = radius * rng.uniform(*HUB)
    height, width = radius * rng.uniform(*HEIGHT), radius * rng.uniform(*WIDTH)
    above = radius * rng.uniform(1.2, 2.0)
    center = tip[:3, 3] - outwards * (hub + above)
    count = int(2.0 * math.pi * (hub + above) / (radius * rng.uniform(*GAP)))
    twist = rng.uniform(*TWIST)
    # Rows lie on either side of the one with the target, and the target's is not always in the middle of it.
    middle = rng.uniform(-0.3, 0.3) * width
    rows, before = int(rng.integers(*DRUM_ROWS)), int(rng.integers(0, 2))
    frame = np.stack([outwards, np.cross(axis, outwards), axis], axis=-1)
    pitch = width + 1.5 * radius
    half = (abs(middle) + rows * pitch) * axis
    obstacles: list[Obstacle] = [sn.Cylinder(center - half, center + half, hub, name="drum")]
    for row in range(rows):
        lift = middle + (row - min(before, rows - 1)) * pitch
        first = 0.5 if row == min(before, rows - 1) else rng.random()
        blades = [
            _blade(2.0 * math.pi * (j + first) / count, hub, height, width, lift, DRUM_THICKNESS * radius, twist)
            for j in range(count)
        ]
        placed = joined(blades)
        surface = Surface(placed.vertices @ frame.T + center, placed.faces)
        obstacles.append(solid(surface, f"blades {row + 1}"))
    return Sketch(robot, obstacles, q)


def _blade(
    angle: float, hub: float, height: float, width: float, lift: float, thickness: float, twist: float
) -> Surface:
    """One blade about the z axis, with its root a little in the drum."""
    shares = np.linspace(0.0, 1.0, STEPS + 1)
    corners = 0.5 * np.array([[-thickness, -width], [thickness, -width], [thickness, width], [-thickness, width]])
    rings = []
    for share in shares:
        turned = corners @ about_z(twist * share)[:2, :2].T
        ring = np.stack([np.full(4, 0.98 * hub + share * height), turned[:, 0], lift + turned[:, 1]], axis=-1)
        rings.append(ring @ about_z(angle)[:3, :3].T)
    stacked = np.array(rings)
    return loft(stacked, stacked[[0, -1]].mean(axis=1))


OPENING = (3.5, 6.0)
"""Width and height of a compartment inside."""

DEPTH, BOARD = (5.0, 10.0), 0.4
"""Of a compartment; thickness of boards. All in radii of the body."""

COLUMNS, SHELF_ROWS = (2, 5), (2, 5)


def shelf(robot: sn.Robot, rng: Generator) -> Sketch:
    """Put the shelf around the hidden tip, open to where it comes from."""
    radius = min(robot.radii)
    q = draw_shape(robot, 4.0 * radius, rng)
    tip = curve_of(robot, q, 2).poses[-1]
    board = BOARD * radius
    sizes = np.array([*(radius * rng.uniform(*OPENING, 2)), radius * rng.uniform(*DEPTH)])
    counts = np.array([rng.integers(*COLUMNS), rng.integers(*SHELF_ROWS)])
    cell = rng.integers(0, counts)
    pitch = sizes[:2] + board
    # The tip: off the middle of its compartment, and near its back.
    off = rng.uniform(-0.5, 0.5, 2) * (sizes[:2] - 3.0 * radius)
    low = np.array([*(-(cell + 0.5) * pitch - off), radius * rng.uniform(1.3, 2.5) - sizes[2]])
    high = np.array([*(low[:2] + counts * pitch), low[2] + sizes[2]])
    half = 0.5 * board
    back = np.array([*(low[:2] - half), high[2]]), np.array([*(high[:2] + half), high[2] + board])
    boards = [box_between(tip, *back, "back")]
    for axis, kind in enumerate(("side", "shelf")):
        for i in range(counts[axis] + 1):
            a, b = low.copy(), high.copy()
            a[1 - axis] -= half
            b[1 - axis] += half
            a[axis], b[axis] = low[axis] + i * pitch[axis] - half, low[axis] + i * pitch[axis] + half
            boards.append(box_between(tip, a, b, f"{kind} {i + 1}"))
    return Sketch(robot, boards, q)


INSIDE, OUTSIDE = 1.7, 2.6
"""Radii of the wall, in radii of the body."""

DUCT_FEWEST, DUCT_MOST = 2, 4
BRANCH = (10.0, 20.0)
"""Length of a dead end, in radii of the body."""

BEND = (0.6, 1.8)
"""Of a dead end, away from the right way, rad."""

CELL = 1.0
"""Of the grid that the wall is made on, in radii of the body."""

STEP = 0.25
"""Between points of the curves that the wall is made around, in radii of the body."""

TRIES = 30


def duct(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Wall in the hidden shape and some dead ends that leave it."""
    radius = min(robot.radii)
    q = draw_shape(robot, 2.1 * OUTSIDE * radius, rng)
    samples = math.ceil(max(q[:, 2]) / (STEP * radius))
    main = lengthened(curve_of(robot, q, samples).poses, INSIDE * radius)
    draw, wanted = partial(_branch, main, radius, rng), int(rng.integers(DUCT_FEWEST, DUCT_MOST + 1))
    ends = offshoots(main[:, :3, 3], draw, wanted, TRIES, OUTSIDE * radius)
    if len(ends) < DUCT_FEWEST:
        return None
    tree = cKDTree(np.concatenate([main[:, :3, 3], *ends]))
    cell = CELL * radius
    wall = joined([_at(tree, OUTSIDE * radius, cell), _at(tree, INSIDE * radius, cell).turned])
    return Sketch(robot, [solid(wall, "duct")], q)


def _branch(main: Floats, radius: float, rng: Generator) -> Floats:
    """Draw an arc that leaves the way somewhere, to any side but the one that the way bends to."""
    at = int(rng.uniform(0.15, 0.85) * len(main))
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
