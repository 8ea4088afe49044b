"""What is put around a hidden motion and leaves room for all of it: balls, plates of bars, cells with doors, pipes."""

import math

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.judges.kinematics import body_points
from benchmarks.judges.motions import samples
from benchmarks.places.cells import WALL as WALLS
from benchmarks.places.cells import Cell, cell_around, common_wall, in_frame
from benchmarks.places.parts.shapes import curve_of
from benchmarks.places.parts.surfaces import WALL, open_tube, solid
from benchmarks.places.tubes import RINGS
from sinuous.base.checks import Floats

SAMPLES = 10
"""Intervals of a segment where the body is looked at."""

LEAST_GAP, MOST_GAP = 0.2, 6.0
"""Range of the room that a ball leaves beside a shape on the way; cubes of an even draw, so that most are close."""

SMALLEST, LARGEST = 1.5, 5.0
"""Range of the radius of a ball."""

FROM = 0.3
"""Share of the motion after which balls are beside it: before, the robot is straight."""

FEWEST, MOST = 2, 4
"""Range of the number of plates."""

HALF, BAR, THICKNESS, OPEN = 10.0, 0.8, 0.5, 0.4
"""Half the edge of a plate; width of its bars; its thickness; and the least room beside the motion in its opening.

All but shares and numbers in radii of the body.
"""

BEYOND = (0.04, 0.1)
"""How far a door is beyond where the tip begins, in lengths of the hidden shape."""

GAP = (0.2, 0.45)
"""Least room beside the motion in a door and in a pipe, in radii of the body."""

WIDEST = 3.0
"""Half of the wider side of a door, and the inner radius of a pipe, at most, in radii of the body."""

FINE = 4
"""Frames along a pipe for each of its rings, where its width is measured."""

ENDS = (0.1, 0.5)
"""How far before the tip a pipe ends, in what of the hidden shape is beyond its beginning."""

ALONG = 1.0
"""How much farther than `WIDEST` from the axis of a pipe a body counts as one in it, in radii of the body."""

PATIENCE = 400
"""Balls that are drawn for each that is wanted."""


def swept(robot: sn.Robot, knots: Floats) -> Floats:
    """Points (m, 3) of the backbone on the whole way, that no place of it is far from."""
    points, _ = body_points(robot, samples(knots), SAMPLES)
    return points.reshape(-1, 3)


def balls(robot: sn.Robot, knots: Floats, rng: Generator, count: int) -> list[sn.Sphere] | None:
    """Put balls beside shapes of a motion (T, n, 3), clear of all of it; `None` where there is no room for so many."""
    unit, tree = max(robot.radii), cKDTree(swept(robot, knots))
    way = samples(knots)
    found: list[sn.Sphere] = []
    for _ in range(PATIENCE * count):
        size = unit * rng.uniform(SMALLEST, LARGEST)
        gap = unit * (LEAST_GAP + (MOST_GAP - LEAST_GAP) * rng.random() ** 3)
        shape = way[int(rng.uniform(FROM, 1.0) * len(way))]
        points = curve_of(robot, shape, SAMPLES).points
        aside = rng.normal(size=3)
        center = points[rng.integers(len(points))] + (size + unit + gap) * aside / np.linalg.norm(aside)
        if tree.query(center)[0] >= size + (1.0 + LEAST_GAP) * unit:
            found.append(sn.Sphere(center, size))
            if len(found) == count:
                return found
    return None


def plates(robot: sn.Robot, knots: Floats, rng: Generator) -> list[sn.Box]:
    """Put plates of bars across the shape where a motion (T, n, 3) ends, with openings that the motion needs."""
    unit, points = max(robot.radii), swept(robot, knots)
    poses = curve_of(robot, knots[-1], 40).poses
    count = int(rng.integers(FEWEST, MOST + 1))
    shares = 0.25 + 0.65 * (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count
    return [
        bar
        for number, share in enumerate(shares)
        for bar in _plate(poses[round(share * (len(poses) - 1))], points, unit, f"plate {number + 1}")
    ]


def _plate(pose: Floats, points: Floats, unit: float, name: str) -> list[sn.Box]:
    """Cut a plate across a frame (4, 4) into bars, and leave out what is too near to points (m, 3)."""
    room, thick, width = (1.0 + OPEN) * unit, 0.5 * THICKNESS * unit, BAR * unit
    local = (points - pose[:3, 3]) @ pose[:3, :3]
    local = local[np.abs(local[:, 2]) < room + thick]
    deep = np.maximum(np.abs(local[:, 2]) - thick, 0.0)
    count = math.ceil(2.0 * HALF / BAR)
    middles = width * (np.arange(count) - 0.5 * (count - 1))
    aside = np.maximum(np.abs(local[:, :2, None] - middles) - 0.5 * width, 0.0)
    near = (aside[:, 0, :, None] ** 2 + aside[:, 1, None, :] ** 2 + deep[:, None, None] ** 2 < room**2).any(axis=0)
    found: list[sn.Box] = []
    for row in range(count):
        edges = np.flatnonzero(np.diff(np.concatenate([[True], near[row], [True]]).astype(int)))
        for first, last in edges.reshape(-1, 2):
            middle = np.array([middles[row], 0.5 * (middles[first] + middles[last - 1]), 0.0])
            size = np.array([width, (last - first) * width, 2.0 * thick])
            found.append(
                sn.Box(pose[:3, 3] + pose[:3, :3] @ middle, size, pose[:3, :3], name=f"{name}, {len(found) + 1}")
            )
    return found


def door_in(robot: sn.Robot, knots: Floats, rng: Generator) -> list[sn.Box] | None:
    """Put a cell with one door around where a motion (T, n, 3) ends; `None` where it needs too wide a door."""
    cells = _cells(robot, knots, rng)
    return None if cells is None else cells[1].boxes("cell")


def door_out(robot: sn.Robot, knots: Floats, rng: Generator) -> list[sn.Box] | None:
    """Put a cell with one door around the base; `None` as before."""
    cells = _cells(robot, knots, rng)
    return None if cells is None else cells[0].boxes("cell")


def two_doors(robot: sn.Robot, knots: Floats, rng: Generator) -> list[sn.Box] | None:
    """Put cells around both ends, whose common wall has a slit, too, that is too narrow; `None` as before."""
    cells = _cells(robot, knots, rng)
    return None if cells is None else common_wall(*cells, min(robot.radii), rng)


def _cells(robot: sn.Robot, knots: Floats, rng: Generator) -> tuple[Cell, Cell] | None:
    """Cells on both sides of the middle of a wall: around the base, and around where the motion ends."""
    points, unit = swept(robot, knots), max(robot.radii)
    frame = _ahead(robot, knots, rng)[0]
    local = in_frame(frame, points)
    through = local[np.abs(local[:, 2]) < (1.0 + WALLS[1]) * unit, :2]
    low, high = through.min(axis=0), through.max(axis=0)
    half = 0.5 * (high - low) + (1.0 + rng.uniform(*GAP)) * unit
    begin = in_frame(frame, curve_of(robot, knots[0], RINGS).points)
    if half.max() > WIDEST * unit or begin[:, 2].max() > 0.0:
        return None
    frame[:3, 3] += frame[:3, :2] @ (0.5 * (low + high))
    before, after = points[local[:, 2] <= 0.0], points[local[:, 2] >= 0.0]
    flipped = frame @ np.diag([1.0, -1.0, -1.0, 1.0])
    first, other = (cell_around(side, at, half, unit, rng) for side, at in ((before, frame), (after, flipped)))
    return None if first is None or other is None else (first, other)


def _ahead(robot: sn.Robot, knots: Floats, rng: Generator) -> Floats:
    """Frames (m, 4, 4) along the hidden shape, `FINE` a ring, from a little beyond where the tip begins."""
    curve = curve_of(robot, knots[-1], FINE * RINGS)
    tip = curve_of(robot, knots[0], RINGS).points[-1]
    begin = int(np.linalg.norm(curve.points - tip, axis=1).argmin())
    begin += round(rng.uniform(*BEYOND) * (len(curve.poses) - 1))
    return curve.poses[min(begin, len(curve.poses) - 1 - FINE) :].copy()


def pipe(robot: sn.Robot, knots: Floats, rng: Generator) -> list[sn.Mesh] | None:
    """Put a pipe, open at both ends, where a motion (T, n, 3) leads in; `None` as before."""
    unit = max(robot.radii)
    ahead = _ahead(robot, knots, rng)
    axis = ahead[: max(FINE + 1, round((1.0 - rng.uniform(*ENDS)) * len(ahead)))]
    gaps, at = map(np.asarray, cKDTree(axis[:, :3, 3]).query(swept(robot, knots)))
    along = gaps[(at > 0) & (at < len(axis) - 1) & (gaps < (WIDEST + ALONG) * unit)]
    inside = float(along.max(initial=0.0)) + (1.0 + rng.uniform(*GAP)) * unit
    if inside > WIDEST * unit:
        return None
    return [solid(open_tube(axis[::FINE], inside, inside + WALL * unit), "pipe")]
