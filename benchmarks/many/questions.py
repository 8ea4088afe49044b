"""Tables of targets that can be reached, drawn in chunks, whatever their number."""

from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.harness.plan import Plan
from benchmarks.problems import among_spheres, arm, random_configurations
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.scene import Scene

ROBOT = arm(5, 2.4, radius=4)
SPHERES = 40
TOGETHER = 100_000


def spheres(plan: Plan) -> Scene:
    """The obstacles that the robot works among."""
    return among_spheres(ROBOT, SPHERES, 1, plan.rng(30)).scene


def tips(robot: Robot, count: int, rng: np.random.Generator) -> Floats:
    """Poses (count, 4, 4) of the tips of random shapes."""
    return np.asarray(robot.tip(random_configurations(robot, count, rng)))


def table(file: Path, count: int, rng: np.random.Generator, directions: bool) -> Path:
    """Write an NPZ file of positions, and perhaps directions, that random shapes have."""
    arrays: dict[str, Any] = {"positions": np.empty((count, 3))}
    if directions:
        arrays["directions"] = np.empty((count, 3))
    for first in range(0, count, TOGETHER):
        some = tips(ROBOT, min(TOGETHER, count - first), rng)
        arrays["positions"][first : first + len(some)] = some[:, :3, 3]
        if directions:
            arrays["directions"][first : first + len(some)] = some[:, :3, 2]
    np.savez(file, **arrays)
    return file
