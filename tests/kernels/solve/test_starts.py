"""Starts: the single arc, even samples of the limits, and shapes turned to face the goal."""

import math

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.solve import starts
from sinuous.kernels.step.scattered import scattered
from tests.helpers import Floats, expm_chain, frames_of, random_pose, vec

MIXED = sn.Robot(
    [
        sn.Segment((0.5, 2.0), 2.0),
        sn.Segment((0.5, 2.0), 6.0, max_curvature=1.5),
        sn.Segment((0.0, 1.0), 1.0),
        sn.Segment(1.0, 0.0),
        sn.Segment(0.7, math.pi),
        sn.Segment(1.0, (-0.5, 2.0), plane=0.3),
    ]
)


def single_arc(robot: sn.Robot, goal: Floats, tip: int, base: Floats) -> Floats:
    q = np.full((len(robot), 3), np.nan)
    starts.put_single_arc(robot.limits, frames_of(np.zeros((len(robot), 3)), base), tip, vec(goal), q)
    return q


@pytest.mark.parametrize("seed", range(10))
def test_the_single_arc_ends_at_the_goal_where_lengths_and_bends_allow(seed: int) -> None:
    rng = np.random.default_rng(seed)
    base = random_pose(rng)
    tip = int(rng.integers(1, 6))
    robot = sn.Robot.uniform(6, (0.01, 5.0), max_bend=7.0)
    bend, angle = rng.choice([0.0, 1e-6, 1.0, 3.0, 5.0]), rng.uniform(-math.pi, math.pi)
    goal = expm_chain(np.array([[bend * math.cos(angle), bend * math.sin(angle), 3.0]]), base)[-1][:3, 3]
    q = single_arc(robot, goal, tip, base)
    np.testing.assert_allclose(expm_chain(q, base)[tip + 1][:3, 3], goal, atol=1e-9)
    np.testing.assert_array_equal(q[tip + 1 :, :2], 0.0)
    assert q[: tip + 1, 2].sum() == pytest.approx(3.0)


@pytest.mark.parametrize("seed", range(10))
def test_every_start_keeps_the_limits(seed: int) -> None:
    rng = np.random.default_rng(seed)
    goals = [rng.normal(size=3) * s for s in (1e-9, 0.5, 5.0, 100.0)] + [
        np.zeros(3),
        np.array([0, 0, 3.0]),
        np.array([0, 0, -3.0]),
    ]
    for goal in goals:
        for tip in (0, 2, len(MIXED) - 1):
            q = single_arc(MIXED, goal, tip, np.eye(4))
            assert np.isfinite(q).all()
            assert MIXED.excess(q) <= 1e-12
    q = np.full((len(MIXED), 3), np.nan)
    for most in (0.2, math.pi, 2.0 * math.pi):
        scattered(MIXED.limits, int(rng.integers(10**6)), seed, most, q)
        assert MIXED.excess(q) <= 1e-12
        assert np.hypot(q[:, 0], q[:, 1]).max() <= most * (1.0 + 1e-12)


def sequence(seed: int, count: int, robot: sn.Robot = MIXED, most: float = math.pi) -> Floats:
    out = np.empty((count, len(robot), 3))
    for i in range(count):
        scattered(robot.limits, i, seed, most, out[i])
    return out


def test_shapes_cover_the_limits_evenly() -> None:
    q = sequence(0, 4000)
    bends = q[:, 0, :2] / 2.0  # within the unit disc
    quantiles = np.linspace(0.05, 0.95, 19)
    np.testing.assert_allclose(np.quantile((bends**2).sum(axis=1), quantiles), quantiles, atol=0.03)
    turns = (np.arctan2(bends[:, 1], bends[:, 0]) + math.pi) / (2 * math.pi)
    np.testing.assert_allclose(np.quantile(turns, quantiles), quantiles, atol=0.03)
    np.testing.assert_allclose(np.quantile((q[:, 0, 2] - 0.5) / 1.5, quantiles), quantiles, atol=0.03)
    # Neighbouring coordinates and segments have nothing to do with each other.
    columns = np.stack([bends[:, 0], bends[:, 1], q[:, 0, 2], q[:, 1, 2], q[:, 2, 2], q[:, 4, 0]])
    np.testing.assert_allclose(np.corrcoef(columns), np.eye(len(columns)), atol=0.06)
