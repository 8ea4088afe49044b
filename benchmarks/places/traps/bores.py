"""Blind bores in a block: the target is near the bottom, the base outside."""

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.shapes import draw_shape
from benchmarks.places.parts.surfaces import blind_bore, solid
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.places.traps.boxes import box_between, channel
from benchmarks.places.traps.cells import SAMPLES, in_frame, line_of
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot

WIDTH, BLOCK, BOTTOM = (1.3, 1.8), (3.0, 8.0), (1.1, 3.0)
"""Inner radius of a bore; half the edge of the block; how far the bottom is beyond the tip. In radii of the body."""


def bore(robot: Robot, rng: Generator) -> Sketch | None:
    """Drill a round bore into a block, a mesh."""
    radius = max(robot.radii)
    width, block = radius * rng.uniform(*WIDTH), radius * rng.uniform(*BLOCK)
    q, frame, depth = _drilled(robot, rng)
    if not _tool_fits(robot, q, frame, width):
        return None
    return sketch_of(robot, [solid(blind_bore(frame, width, depth, block, radius), "block")], q, rng)


def square_bore(robot: Robot, rng: Generator) -> Sketch | None:
    """Leave a square bore between four boxes and one at the bottom."""
    radius = max(robot.radii)
    width, block = radius * rng.uniform(*WIDTH), radius * rng.uniform(*BLOCK)
    q, frame, depth = _drilled(robot, rng)
    if not _tool_fits(robot, q, frame, width):
        return None
    low, high = np.array([-block, -block, depth]), np.array([block, block, depth + radius])
    bottom = box_between(frame, low, high, "bottom")
    return sketch_of(robot, [*channel(frame, width, depth, block - width), bottom], q, rng)


def _drilled(robot: Robot, rng: Generator) -> tuple[Floats, Floats, float]:
    """Configuration whose last segments are straight, frame (4, 4) of the mouth with z into the bore, and its depth."""
    n, radius = len(robot), max(robot.radii)
    count = int(rng.integers(1, max(2, n // 3)))
    q = draw_shape(robot, 4.0 * radius, rng, straight=range(n - count, n))
    line = line_of(robot, q)
    mouth = line.poses[round(rng.uniform(n - count, n - 0.5) * SAMPLES)]
    local = in_frame(mouth, np.stack([line.poses[-1, :3, 3], line.end]))
    depth = float(local[0, 2] + max(radius * rng.uniform(*BOTTOM), local[1, 2] - local[0, 2] + 0.3 * radius))
    return q, mouth, depth


def _tool_fits(robot: Robot, q: Floats, frame: Floats, width: float) -> bool:
    """Whether the tool is not in the wall."""
    tool = in_frame(frame, line_of(robot, q).end[None])[0]
    return float(np.linalg.norm(tool[:2])) < width - 0.2 * max(robot.radii)
