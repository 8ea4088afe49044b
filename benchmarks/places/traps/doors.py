"""Cells with doors around the base, around the target, or around both."""

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.shapes import draw_shape
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.places.traps.boxes import wall_with_door
from benchmarks.places.traps.cells import Cell, Line, cell_around, doorway, draw_half, in_frame, line_of
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Box

SHARE = (0.25, 0.75)
"""Of the shape, how much is on one side of the door."""

APART = 4.0
"""Distance of the shape from itself, in radii of the body."""

ASIDE = 0.2
"""Largest cosine of the angle between the base's tangent and the direction of a door that is beside or behind it."""

LATE = 0.9
"""Largest share of the shape before such a door."""

SHAPES = 20
"""Shapes drawn for one: few turn back."""

FOLDED, FOLDS = (0.5, 0.85), 0.45
"""Share of a folded shape in its room; largest diagonal of that part, of its length."""

HALL = 1000.0
"""Edge of a hall, in radii of the body."""

SLIT = (0.5, 0.9)
"""Half of the narrower side of a door that is too narrow, in the smallest radius of the body."""


def door_out(robot: Robot, rng: Generator) -> Sketch | None:
    """Put the base into a cell with one door, the target outside."""
    q, line, k = _drawn(robot, rng)
    return _cell_at_base(robot, q, line, k, rng)


def door_in(robot: Robot, rng: Generator) -> Sketch | None:
    """Put the target into a cell with one door, the base outside."""
    q, line, k = _drawn(robot, rng)
    frame = doorway(line.poses[k], rng, inwards=True)
    cell = cell_around(line.after(k), frame, draw_half(line.radius, rng), line.radius, rng)
    if cell is None or not cell.keeps_out(line.before(k), line.radius):
        return None
    return sketch_of(robot, cell.boxes("cell"), q, rng)


def door_beside(robot: Robot, rng: Generator) -> Sketch | None:
    """Put the base into a cell whose door is beside or behind it: the tangent forbids the shortest route."""
    for _ in range(SHAPES):
        q, line, _ = _drawn(robot, rng)
        ways = line.poses[:, :3, 3] - line.poses[0, :3, 3]
        behind = ways @ line.poses[0, :3, 2] <= ASIDE * np.linalg.norm(ways, axis=1)
        last = len(ways) - 1
        doors = [k for k in range(round(SHARE[0] * last), round(LATE * last)) if behind[k]]
        found = _cell_at_base(robot, q, line, int(rng.choice(doors)), rng) if doors else None
        if found is not None:
            return found
    return None


def folded(robot: Robot, rng: Generator) -> Sketch | None:
    """Fold most of the robot into the cell at its base."""
    q, line, k = _drawn(robot, rng, FOLDED)
    points = line.before(k)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    if np.linalg.norm(np.ptp(in_frame(line.poses[k], points), axis=0)) > FOLDS * length:
        return None
    return _cell_at_base(robot, q, line, k, rng)


def hall(robot: Robot, rng: Generator) -> Sketch | None:
    """Put the base into a cell so large that a search which looks everywhere has much to look at."""
    q, line, k = _drawn(robot, rng)
    frame, radius = doorway(line.poses[k], rng), line.radius
    cell = cell_around(line.before(k), frame, draw_half(radius, rng), radius, rng)
    if cell is None:
        return None
    spare = np.maximum(HALL * radius - (cell.high - cell.low), 0.0)
    share = np.append(rng.random(2), 1.0)
    large = cell._replace(low=cell.low - share * spare, high=cell.high + (1.0 - share) * spare)
    return sketch_of(robot, large.boxes("hall"), q, rng) if large.keeps_out(line.after(k), radius) else None


def two_doors(robot: Robot, rng: Generator) -> Sketch | None:
    """Put base and target into two cells whose common wall has two doors, of which one is too narrow."""
    q, line, k = _drawn(robot, rng)
    frame, half = doorway(line.poses[k], rng), draw_half(line.radius, rng)
    first = cell_around(line.before(k), frame, half, line.radius, rng)
    flip = np.diag([1.0, -1.0, -1.0, 1.0])
    other = cell_around(line.after(k), frame @ flip, half, line.radius, rng)
    if first is None or other is None:
        return None
    common = common_wall(first, other, min(robot.radii), rng)
    return None if common is None else sketch_of(robot, common, q, rng)


def _drawn(robot: Robot, rng: Generator, share: tuple[float, float] = SHARE) -> tuple[Floats, Line, int]:
    """Draw a shape, and the number of the frame where it goes through a wall."""
    q = draw_shape(robot, APART * max(robot.radii), rng)
    line = line_of(robot, q)
    return q, line, round(rng.uniform(*share) * (len(line.poses) - 1))


def _cell_at_base(robot: Robot, q: Floats, line: Line, k: int, rng: Generator) -> Sketch | None:
    frame = doorway(line.poses[k], rng)
    cell = cell_around(line.before(k), frame, draw_half(line.radius, rng), line.radius, rng)
    if cell is None or not cell.keeps_out(line.after(k), line.radius):
        return None
    return sketch_of(robot, cell.boxes("cell"), q, rng)


def common_wall(first: Cell, other: Cell, thin: float, rng: Generator) -> list[Box] | None:
    """Walls of two cells on both sides of a wall with the door of the first, and a slit beside it.

    `None` where no room is left for the slit.
    """
    flipped_low, flipped_high = other.low[:2] * [1.0, -1.0], other.high[:2] * [1.0, -1.0]
    low = np.minimum(first.low[:2], np.minimum(flipped_low, flipped_high))
    high = np.maximum(first.high[:2], np.maximum(flipped_low, flipped_high))
    wall = first.wall
    low, high = np.append(low - wall, -0.5 * wall), np.append(high + wall, 0.5 * wall)
    both = _overlap(first, other)
    slit = thin * np.array([rng.uniform(*SLIT), rng.uniform(1.0, 4.0)])
    centers = rng.uniform(both[0] + slit, np.maximum(both[1] - slit, both[0] + slit), (20, 2))
    right = centers[:, 0] - slit[0] > first.half[0] + 0.3 * thin
    if not right.any() or (both[1] - both[0] < 2.0 * slit).any():
        return None
    center = centers[right][0]
    seam = 0.5 * (first.half[0] + center[0] - slit[0])
    left_high, right_low = high.copy(), low.copy()
    left_high[0] = right_low[0] = seam
    real, false = np.array([-first.half, first.half]), np.array([center - slit, center + slit])
    return [
        *first._replace(high=np.append(first.high[:2], -0.5 * wall)).shell("base cell"),
        *other._replace(high=np.append(other.high[:2], -0.5 * wall)).shell("target cell"),
        *wall_with_door(first.frame, low, left_high, real, "door"),
        *wall_with_door(first.frame, right_low, high, false, "slit"),
    ]


def _overlap(first: Cell, other: Cell) -> Floats:
    """Corners (2, 2) of the part of the wall that both cells have, in x and y of the first one's frame."""
    a, b = other.low[:2] * [1.0, -1.0], other.high[:2] * [1.0, -1.0]
    low = np.maximum(first.low[:2], np.minimum(a, b))
    high = np.minimum(first.high[:2], np.maximum(a, b))
    return np.array([low, high])
