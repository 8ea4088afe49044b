"""An open pipe that branches: the base is in one mouth, the other branch is a dead end."""

import math

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

from benchmarks.places.parts.marching import around
from benchmarks.places.parts.shapes import curve_of, draw_shape
from benchmarks.places.parts.surfaces import WALL, solid
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.places.traps.cells import line_of
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot

WIDTH = (1.4, 2.2)
"""Inner radius of a pipe."""

STEP, CELL = 0.25, 0.75
"""Between points of the axes, and edge of the cells of the grid that the wall is made on."""

BRANCH = (10.0, 25.0)
"""Length of the dead end. All four in radii of the body."""

WHERE, ANGLE = (0.2, 0.75), (0.6, 0.5 * math.pi)
"""Where it leaves the pipe, of the shape, and at what angle, rad: a T or a Y."""

OPENED, TRIES = 0.5, 20
"""Share of the pipes that are open behind the base, too; and draws of a branch."""


def branches(robot: Robot, rng: Generator) -> Sketch | None:
    """Put the shape into a pipe that is open beyond the tip, with a dead end on its way."""
    radius, width = max(robot.radii), rng.uniform(*WIDTH)
    q = draw_shape(robot, 2.2 * (width + WALL) * radius, rng)
    curve = curve_of(robot, q, math.ceil(q[:, 2].max() / (STEP * radius)))
    dead = _dead_end(curve.poses, width + WALL, radius, rng)
    if dead is None:
        return None
    tool = np.linspace(curve.points[-1], line_of(robot, q).end, 20)
    axes = np.concatenate([curve.points, dead, tool])
    beyond = np.linspace(0.0, (width + 2.0) * radius, 20)[:, None]
    open_at = [tool[-1] + beyond * curve.tangents[-1]]
    if rng.random() < OPENED:
        open_at.append(curve.points[0] - beyond * curve.tangents[0])
    wall, hollow = cKDTree(axes), cKDTree(np.concatenate([axes, *open_at]))

    def signed(points: Floats) -> Floats:
        to_wall = wall.query(points)[0] - (width + WALL) * radius
        return np.asarray(np.maximum(to_wall, width * radius - hollow.query(points)[0]))

    surface = around(axes, (width + WALL) * radius, CELL * radius, signed)
    return sketch_of(robot, [solid(surface, "pipe")], q, rng)


def _dead_end(poses: Floats, outside: float, radius: float, rng: Generator) -> Floats | None:
    """Points (m, 3) of a straight branch that comes near the pipe (m, 4, 4) only where it leaves it."""
    for _ in range(TRIES):
        at = poses[round(rng.uniform(*WHERE) * (len(poses) - 1))]
        turn, angle = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(*ANGLE)
        sideways = at[:3, :2] @ [math.cos(turn), math.sin(turn)]
        gone = np.arange(0.0, radius * rng.uniform(*BRANCH), STEP * radius)
        points: Floats = at[:3, 3] + gone[:, None] * (math.cos(angle) * at[:3, 2] + math.sin(angle) * sideways)
        far = gone > 3.2 * outside * radius
        if far.any() and np.min(cKDTree(poses[:, :3, 3]).query(points[far])[0]) > 2.1 * outside * radius:
            return points
    return None
