"""From configurations to links and back, and the end that a tool asks for."""

import math

import numpy as np

from sinuous.methods.fabrik.links import STEEPEST
from sinuous.model.robot import Robot
from tests.helpers import Floats


def within(robot: Robot, seed: int) -> Floats:
    """Give a configuration within the limits, and within what a section may turn."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(*robot.limits[:, :2].T)
    bend = rng.random(len(robot)) * np.fmin(robot.limits[:, 2], np.fmin(robot.limits[:, 3] * length, STEEPEST))
    angle = rng.uniform(-math.pi, math.pi, len(robot))
    return np.stack([bend * np.cos(angle), bend * np.sin(angle), length], axis=-1)
