"""A path of arcs: what follows from its points, and what every arc wants."""

import numpy as np

from sinuous.methods.opti_path import path as paths
from sinuous.methods.opti_path.path import Path
from sinuous.model.robot import Robot
from tests.helpers import Floats

N = 6
ROBOT = Robot.uniform(N, (0.8, 1.2), 2.0)


def wavy(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    return np.concatenate([np.zeros((1, 3)), np.cumsum([0.0, 0.0, 0.9] + 0.35 * rng.normal(size=(N, 3)), axis=0)])


def make_path(points: Floats, band: float = 0.0, robot: Robot = ROBOT, mount: float = 0.0) -> Path:
    n = len(points) - 1
    tangents = np.zeros((n + 1, 3))
    tangents[0] = [0.0, 0.0, 1.0]
    path = Path(
        points.copy(),
        points.copy(),
        tangents,
        np.zeros((n, 15)),
        np.zeros((n + 1, 3)),
        np.zeros((n + 1, 3)),
        np.zeros((n, 4)),
    )
    paths.want(robot.limits.copy(), band, mount, path)
    paths.trace(path)
    return path
