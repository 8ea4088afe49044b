"""Small worlds of boxes, quickly made: any robot, a door that it goes through, and boxes wherever there is room."""

import numpy as np
from numpy.random import Generator

from benchmarks.places.place import Sketch, sketch_of
from benchmarks.places.traps.boxes import wall_with_door
from benchmarks.places.traps.cells import Line, cell_around, doorway, draw_half, in_frame, line_of
from sinuous.base.checks import Floats
from sinuous.measures.obstacles import measure
from sinuous.model.poses import pose
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.scene.obstacles import Box

COUNT = (2, 7)
BEND, STRETCH, THICKNESS, MOUNT = (0.8, 3.0), 0.4, (0.03, 0.13), 0.3
"""Range of the largest bend, rad; most that segments differ in length; range of the radius, and longest mount, of a
segment's length."""

WALL_SIZE = (6.0, 30.0)
"""Range of half the edge of a wall that stands alone, in radii of the body."""

MOST_BOXES = 6
BOX_SIZE = (0.1, 1.0)
"""Range of the edges of a box, of the extent of the shape."""

LEEWAY = 1.15
"""Least distance of a box from the shape, in radii of the body."""


def small_world(seed: int, rng: Generator) -> Sketch | None:
    """Draw a robot and any shape of it, and put a door where the shape passes: in a wall, or in that of a cell."""
    robot = any_robot(rng)
    q = any_shape(robot, rng)
    line = line_of(robot, q)
    k = round(rng.uniform(0.15, 0.9) * (len(line.poses) - 1))
    kind, half = int(rng.integers(3)), draw_half(line.radius, rng)
    frame = doorway(line.poses[k], rng, inwards=kind == 2)
    if kind == 0:
        doors = _wall(frame, half, line.radius, rng)
    else:
        inner, outer = (line.before(k), line.after(k)) if kind == 1 else (line.after(k), line.before(k))
        cell = cell_around(inner, frame, half, line.radius, rng)
        if cell is None or not cell.keeps_out(outer, line.radius):
            return None
        doors = cell.boxes("cell")
    points = line.poses[:, :3, 3]
    if min(measure(box, points).min() for box in doors) < line.radius and robot.mount == 0.0:
        return None
    return sketch_of(robot, [*doors, *_boxes(line, rng)], q, rng)


def any_robot(rng: Generator) -> Robot:
    """Draw a robot of any size, alike or different segments, some with an insertion stage or a mount."""
    unit = 10.0 ** rng.uniform(-2.0, 2.0)
    radius = unit * rng.uniform(*THICKNESS)
    max_bend, stretch = rng.uniform(*BEND), rng.choice([0.0, STRETCH]) * rng.random()
    lengths = unit * (1.0 + rng.choice([0.0, 0.4]) * rng.uniform(-1.0, 1.0, int(rng.integers(*COUNT))))
    segments = [Segment((length * (1.0 - stretch), length), max_bend, radius=radius) for length in lengths]
    if rng.random() < 0.25:
        segments.insert(0, Segment((0.0, unit * rng.uniform(0.5, 2.0)), 0.0, radius=radius))
    mount = rng.choice([0.0, 0.0, MOUNT]) * unit * rng.random()
    return Robot(segments, mount=mount, base=pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)))


def any_shape(robot: Robot, rng: Generator) -> Floats:
    """Draw a configuration (n, 3) evenly within its limits."""
    low, high, bends = np.array([(*segment.length, segment.max_bend) for segment in robot.segments]).T
    turn, size = 2.0 * np.pi * rng.random(len(robot)), bends * np.sqrt(rng.random(len(robot)))
    return np.stack([size * np.cos(turn), size * np.sin(turn), rng.uniform(low, high)], axis=-1)


def _wall(frame: Floats, half: Floats, radius: float, rng: Generator) -> list[Box]:
    """Return a wall of any size around a door."""
    low, high = -half - radius * rng.uniform(*WALL_SIZE, 2), half + radius * rng.uniform(*WALL_SIZE, 2)
    thick = 0.5 * radius * rng.uniform(0.4, 2.0)
    return wall_with_door(frame, np.append(low, -thick), np.append(high, thick), np.array([-half, half]), "wall")


def _boxes(line: Line, rng: Generator) -> list[Box]:
    """Return boxes that leave the shape alone."""
    points = line.poses[:, :3, 3]
    local = in_frame(line.poses[0], points)
    extent = np.ptp(local, axis=0)
    size = float(np.linalg.norm(extent))
    found = list[Box]()
    for _ in range(int(rng.integers(0, MOST_BOXES + 1))):
        center = points[rng.integers(len(points))] + 0.4 * size * rng.normal(size=3)
        box = Box(center, size * rng.uniform(*BOX_SIZE, 3) ** 2, rng.normal(size=4), name=f"box {len(found) + 1}")
        if measure(box, points).min() > LEEWAY * line.radius:
            found.append(box)
    return found
