"""From cell to cell through a pipe, straight or bent, of boxes or a mesh."""

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.shapes import draw_shape
from benchmarks.places.parts.surfaces import WALL, open_tube, solid
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.places.traps.boxes import channel
from benchmarks.places.traps.cells import SAMPLES, Line, cell_around, line_of
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Obstacle

WIDTH = (1.3, 1.8)
"""Inner radius of a pipe, half the side of a channel, in radii of the body."""

FLIP = np.diag([1.0, -1.0, -1.0, 1.0])
"""Turns a frame about its x axis, so that z leads back."""


def channel_between_cells(robot: Robot, rng: Generator) -> Sketch | None:
    """Put base and target into two cells that a straight channel of boxes leads between."""
    radius, width = max(robot.radii), rng.uniform(*WIDTH)
    n = len(robot)
    first = int(rng.integers(1, n - 1))
    straight = range(first, min(n - 1, first + 1 + n // 5))
    q = _shape(robot, width, straight, rng)
    line = line_of(robot, q)
    begin, end = straight.start * SAMPLES, straight.stop * SAMPLES
    cells = _cells(line, begin, end, width * radius, rng)
    if cells is None:
        return None
    length = float(np.linalg.norm(line.poses[end, :3, 3] - line.poses[begin, :3, 3]))
    return sketch_of(
        robot, [*cells, *channel(line.poses[begin], width * radius, length, WALL * radius, "channel")], q, rng
    )


def pipe_between_cells(robot: Robot, rng: Generator) -> Sketch | None:
    """Put base and target into two cells of boxes that a bent pipe leads between, a mesh."""
    radius, width = max(robot.radii), rng.uniform(*WIDTH)
    q = _shape(robot, width, range(0), rng)
    line = line_of(robot, q)
    begin, end = (round(share * (len(line.poses) - 1)) for share in (rng.uniform(0.2, 0.4), rng.uniform(0.5, 0.8)))
    cells = _cells(line, begin, end, width * radius, rng)
    if cells is None:
        return None
    wall = open_tube(line.poses[begin : end + 1], width * radius, (width + WALL) * radius)
    return sketch_of(robot, [*cells, solid(wall, "pipe")], q, rng)


def _shape(robot: Robot, width: float, straight: range, rng: Generator) -> Floats:
    return draw_shape(robot, 2.1 * (width + WALL) * max(robot.radii), rng, straight=straight)


def _cells(line: Line, begin: int, end: int, half: float, rng: Generator) -> list[Obstacle] | None:
    """Walls of the cells before frame `begin` and after frame `end`; each leaves the rest of the shape outside."""
    door = np.array([half, half])
    at_base = cell_around(line.before(begin), line.poses[begin], door, line.radius, rng)
    at_target = cell_around(line.after(end), line.poses[end] @ FLIP, door, line.radius, rng)
    if at_base is None or at_target is None:
        return None
    if not (at_base.keeps_out(line.after(begin), line.radius) and at_target.keeps_out(line.before(end), line.radius)):
        return None
    return [*at_base.boxes("base cell"), *at_target.boxes("target cell")]
