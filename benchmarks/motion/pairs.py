"""P5: pairs of free states in random clutter, after the planning benchmark of CR-Solver (2026).

n sections of length 1, bent by up to half a turn; n^3 spheres, or more of them, with centres even in a cube of
half-side n and radii from 0.15 to 0.30, off the straight robot; start and goal are drawn evenly from the states that
are clear, with tips at least a tenth of the length apart. The body has a radius of 0.05 and must not run through
itself.
"""

from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from benchmarks.judges import self_collision
from benchmarks.judges.clearances import Clearances
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene

RADIUS = 0.05

TOGETHER, MOST_DRAWS = 64, 4096
"""States that are drawn at once, and how many before the spheres are drawn anew."""


class Pair(NamedTuple):
    """A robot among spheres, and two of its configurations (n, 3)."""

    robot: Robot
    scene: Scene
    start: Floats
    goal: Floats


def draw(segments: int, density: int, number: int, seed: int) -> Pair:
    """Return pair `number` of a seed, with `density` times n^3 spheres."""
    rng = np.random.default_rng([seed, segments, density, number])
    robot = Robot([Segment(1.0, np.pi, radius=RADIUS)] * segments)
    while True:
        scene = _spheres(segments, density * segments**3, rng)
        found = _states(robot, scene, rng)
        if found is not None:
            return Pair(robot, scene, *found)


def _spheres(n: int, count: int, rng: Generator) -> Scene:
    spheres: list[Sphere] = []
    while len(spheres) < count:
        center, radius = rng.uniform(-n, n, 3), float(rng.uniform(0.15, 0.30))
        if np.linalg.norm(center - [0.0, 0.0, np.clip(center[2], 0.0, n)]) > radius + RADIUS:
            spheres.append(Sphere(center, radius))
    return Scene(spheres)


def _states(robot: Robot, scene: Scene, rng: Generator) -> tuple[Floats, Floats] | None:
    """Draw a start and a goal; none where the spheres leave too little room."""
    clearances, free = Clearances(robot, scene), np.empty((0, len(robot), 3))
    for _ in range(MOST_DRAWS // TOGETHER):
        q = _shapes(len(robot), rng)
        q = q[clearances.least(q, 0.0) > 0.0]
        free = np.concatenate([free, q[self_collision.surely_clear(robot, q)]])
        far = [i for i in range(1, len(free)) if _apart(robot, free[0], free[i]) >= 0.1 * robot.mean_length]
        if far:
            return free[0], free[far[0]]
    return None


def _shapes(n: int, rng: Generator) -> Floats:
    bends = np.pi * np.sqrt(rng.random((TOGETHER, n)))
    angles = rng.uniform(0.0, 2.0 * np.pi, (TOGETHER, n))
    return np.stack([bends * np.cos(angles), bends * np.sin(angles), np.ones((TOGETHER, n))], axis=-1)


def _apart(robot: Robot, one: Floats, other: Floats) -> float:
    return float(np.linalg.norm(robot.tip(one)[:3, 3] - robot.tip(other)[:3, 3]))
