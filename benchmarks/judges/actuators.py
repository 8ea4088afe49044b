"""Limits of tendons and chambers, from the definition of what drives a segment, in plain NumPy."""

import numpy as np

from benchmarks.judges.self_collision import Flags
from sinuous.base.checks import Floats
from sinuous.model.actuators import Lines
from sinuous.model.robot import Robot


def within(robot: Robot, q: Floats, slack: float) -> Flags:
    """Say for every configuration (m, n, 3) whether all tendons and chambers keep their limits, to within a length."""
    good = np.ones(len(q), bool)
    bends = np.cumsum(q[..., :2], axis=1)
    for k, segment in enumerate(robot.segments):
        if segment.tendons is not None:
            low, high = segment.tendons.displacement
            good &= _between(_pulled(segment.tendons, bends[:, k]), low, high, slack)
        if segment.chambers is not None:
            low, high = segment.chambers.length
            good &= _between(q[:, k, 2:] - _pulled(segment.chambers, q[:, k, :2]), low, high, slack)
    return good


def _pulled(lines: Lines, bends: Floats) -> Floats:
    """By how much bends (m, 2) shorten each line (m, lines): its distance from the backbone, times the bend its way."""
    angle, side = np.hypot(bends[:, 0], bends[:, 1]), np.arctan2(bends[:, 1], bends[:, 0])
    return np.asarray(lines.radius * angle[:, None] * np.cos(side[:, None] - lines.angles))


def _between(values: Floats, low: float, high: float, slack: float) -> Flags:
    return np.asarray((values >= low - slack).all(axis=1) & (values <= high + slack).all(axis=1))
