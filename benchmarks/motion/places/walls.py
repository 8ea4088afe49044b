"""What is put around a hidden motion that threads a hole: cells with a door, and pipes, that leave room for it."""

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

from benchmarks.motion.places.around import swept
from benchmarks.places.parts.shapes import curve_of
from benchmarks.places.parts.surfaces import WALL, open_tube, solid
from benchmarks.places.traps.cells import WALL as WALLS
from benchmarks.places.traps.cells import Cell, cell_around, in_frame
from benchmarks.places.traps.doors import common_wall
from benchmarks.places.traps.pipes import RINGS
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Box

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


def door_in(robot: Robot, knots: Floats, rng: Generator) -> list[Box] | None:
    """Put a cell with one door around where a motion (T, n, 3) ends; `None` where it needs too wide a door."""
    cells = _cells(robot, knots, rng)
    return None if cells is None else cells[1].boxes("cell")


def door_out(robot: Robot, knots: Floats, rng: Generator) -> list[Box] | None:
    """Put a cell with one door around the base; `None` as before."""
    cells = _cells(robot, knots, rng)
    return None if cells is None else cells[0].boxes("cell")


def two_doors(robot: Robot, knots: Floats, rng: Generator) -> list[Box] | None:
    """Put cells around both ends, whose common wall has a slit, too, that is too narrow; `None` as before."""
    cells = _cells(robot, knots, rng)
    return None if cells is None else common_wall(*cells, min(robot.radii), rng)


def _cells(robot: Robot, knots: Floats, rng: Generator) -> tuple[Cell, Cell] | None:
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


def _ahead(robot: Robot, knots: Floats, rng: Generator) -> Floats:
    """Frames (m, 4, 4) along the hidden shape, `FINE` a ring, from a little beyond where the tip begins."""
    curve = curve_of(robot, knots[-1], FINE * RINGS)
    tip = curve_of(robot, knots[0], RINGS).points[-1]
    begin = int(np.linalg.norm(curve.points - tip, axis=1).argmin())
    begin += round(rng.uniform(*BEYOND) * (len(curve.poses) - 1))
    return curve.poses[min(begin, len(curve.poses) - 1 - FINE) :].copy()


def pipe(robot: Robot, knots: Floats, rng: Generator) -> list[Mesh] | None:
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
