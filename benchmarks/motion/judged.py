"""Judges a motion by sampling, with nothing of the library's kernels: limits, obstacles, and the body itself."""

from itertools import pairwise

import numpy as np

from benchmarks.judges import self_collision
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import within_limits
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.scene import Scene

A_STEP = 50
"""Configurations that are looked at in every step."""

GRACE = 1e-9
"""What rounding may make of a clearance, in robot lengths."""


def samples(knots: Floats) -> Floats:
    """Return configurations (m, n, 3) on the way through knots (T, n, 3), `A_STEP` a step and the last."""
    t = np.arange(A_STEP)[:, None, None] / A_STEP
    steps = [(1.0 - t) * one + t * other for one, other in pairwise(knots)]
    return np.concatenate([*steps, knots[-1:]])


def collides(robot: Robot, scene: Scene, knots: Floats) -> str:
    """Say what is wrong with a motion through knots (T, n, 3): a limit, an obstacle, the body itself; or nothing."""
    q = samples(knots)
    grace = GRACE * robot.mean_length
    if not within_limits(robot, q).all():
        return "limit"
    if len(scene) and Clearances(robot, scene).least(q, 0.0).min() < -grace:
        return "obstacle"
    if robot.self_collision == "avoid" and self_collision.look(robot, q, 0.0).least.min() < -grace:
        return "itself"
    return ""
