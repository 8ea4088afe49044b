"""A shelf of boards, and the target deep in one of its compartments."""

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import curve_of, draw_shape
from benchmarks.places.place import Sketch
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Box

OPENING = (3.5, 6.0)
"""Width and height of a compartment inside."""

DEPTH, BOARD = (5.0, 10.0), 0.4
"""Of a compartment; thickness of boards. All in radii of the body."""

COLUMNS, ROWS = (2, 5), (2, 5)


def shelf(seed: int, rng: Generator) -> Sketch:
    """Put the shelf around the hidden tip, open to where it comes from."""
    robot = robot_of(seed, rng)
    radius = min(robot.radii)
    q = draw_shape(robot, 4.0 * radius, rng)
    tip = curve_of(robot, q, 2).poses[-1]
    board = BOARD * radius
    sizes = np.array([*(radius * rng.uniform(*OPENING, 2)), radius * rng.uniform(*DEPTH)])
    counts = np.array([rng.integers(*COLUMNS), rng.integers(*ROWS)])
    cell = rng.integers(0, counts)
    pitch = sizes[:2] + board
    # The tip: off the middle of its compartment, and near its back.
    off = rng.uniform(-0.5, 0.5, 2) * (sizes[:2] - 3.0 * radius)
    low = np.array([*(-(cell + 0.5) * pitch - off), radius * rng.uniform(1.3, 2.5) - sizes[2]])
    high = np.array([*(low[:2] + counts * pitch), low[2] + sizes[2]])
    rotation = tip[:3, :3]

    def board_between(a: Floats, b: Floats, name: str) -> Box:
        return Box(tip[:3, 3] + rotation @ (0.5 * (a + b)), b - a, rotation, name=name)

    half = 0.5 * board
    back = np.array([*(low[:2] - half), high[2]]), np.array([*(high[:2] + half), high[2] + board])
    boards = [board_between(*back, "back")]
    for axis, kind in enumerate(("side", "shelf")):
        for i in range(counts[axis] + 1):
            a, b = low.copy(), high.copy()
            a[1 - axis] -= half
            b[1 - axis] += half
            a[axis], b[axis] = low[axis] + i * pitch[axis] - half, low[axis] + i * pitch[axis] + half
            boards.append(board_between(a, b, f"{kind} {i + 1}"))
    return Sketch(robot, boards, q)
