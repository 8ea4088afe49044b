"""Is a motion as clear as it claims? Limits, obstacles and the body itself, by sampling, without the kernels."""

from itertools import pairwise

import numpy as np

import sinuous as sn
from benchmarks.judges import self_collision
from benchmarks.judges.bodies import needed_body, self_body
from benchmarks.judges.clearances import GRACE, Clearances
from benchmarks.judges.judge import within_limits
from sinuous.base.checks import Floats

A_STEP = 50
"""Configurations that are looked at in every step."""

EXCESS = 1e-6
"""By how much of itself a rate may seem to be exceeded, by differences."""


def samples(knots: Floats, count: int | None = None) -> Floats:
    """Return configurations (m, n, 3) on the way through knots (T, n, 3), so many a step, and the last."""
    count = A_STEP if count is None else count
    t = np.arange(count)[:, None, None] / count
    steps = [(1.0 - t) * one + t * other for one, other in pairwise(knots)]
    return np.concatenate([*steps, knots[-1:]])


def wrong_in(robot: sn.Robot, scene: sn.Scene, knots: Floats, count: int | None = None) -> str:
    """Say what is wrong with a motion through knots (T, n, 3); or nothing. See `wrong_at`."""
    return wrong_at(robot, scene, samples(knots, count))


def wrong_at(robot: sn.Robot, scene: sn.Scene, q: Floats) -> str:
    """Say what is wrong with configurations (m, n, 3): limits, an obstacle, the body itself; or nothing."""
    if not within_limits(robot, q).all():
        return "limits"
    return overlap(robot, scene, q, GRACE * robot.mean_length)


def overlap(body: sn.Robot, scene: sn.Scene, q: Floats, slack: float) -> str:
    """Say whether a body in configurations (m, n, 3) overlaps an obstacle or itself by more than `slack`."""
    if len(scene) and Clearances(needed_body(body), scene).least(q, 0.0).min() < -slack:
        return "overlap"
    if body.self_collision == "avoid" and self_collision.look(self_body(body), q, 0.0).least.min() < -slack:
        return "overlap with itself"
    return ""


def too_fast(change: Floats, seconds: Floats | float, bend: float, length: float) -> bool:
    """Whether changes (m, n, 3) of configurations, each in so many seconds, exceed rates of bends and lengths."""
    rates = change / np.reshape(seconds, (-1, 1, 1))
    bends, lengths = np.hypot(rates[..., 0], rates[..., 1]).max(), np.abs(rates[..., 2]).max()
    return bool(bends > bend * (1.0 + EXCESS) or lengths > length * (1.0 + EXCESS))
