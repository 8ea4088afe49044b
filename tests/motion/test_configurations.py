"""Configurations: distances, limits of segments, and random ones within them."""

import math

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.packing import scales_of
from sinuous.motion.configurations import distances, random_configuration, within_limits

ROBOT = sn.on_stage(sn.Robot.uniform(3, (0.0, 1.2), 2.4, max_curvature=3.0, radius=0.05), 2.0)
ENDLESS = sn.Robot.uniform(2, 1.0, radius=0.01)


def test_the_distance_is_measured_at_mean_lengths() -> None:
    p, q = np.zeros((4, 3)), np.arange(12.0).reshape(4, 3)
    levers, lengths = (2.3, 1.5, 0.9, 0.3), (1.0, 0.6, 0.6, 0.6)
    assert levers[0] == 0.5 * lengths[0] + sum(lengths[1:])
    parts = [(lever * x, lever * y, z) for lever, (x, y, z) in zip(levers, q.tolist(), strict=True)]
    assert distances(ROBOT, np.stack([p, q]))[0] == pytest.approx(
        math.hypot(*(each for part in parts for each in part))
    )


@pytest.mark.parametrize("robot", [ROBOT, ENDLESS])
def test_random_configurations_are_within_limits(robot: sn.Robot) -> None:
    rng = np.random.default_rng(0)
    drawn = np.stack([random_configuration(robot, rng) for _ in range(500)])
    assert max(robot.excess(q) for q in drawn) < 1e-12
    assert np.hypot(drawn[..., 0], drawn[..., 1]).max() <= 2.0 * np.pi
    moves = np.ptp(drawn, axis=0).ravel() > 0.0
    np.testing.assert_array_equal(moves, scales_of(robot.limits).ravel() > 0.0)


def test_what_is_within_limits_stays_and_the_rest_is_brought_there() -> None:
    rng = np.random.default_rng(1)
    q = rng.normal(size=(300, 4, 3)) * [3.0, 3.0, 1.0] + [0.0, 0.0, 0.8]
    brought = within_limits(ROBOT, q)
    assert max(ROBOT.excess(each) for each in brought) < 1e-12
    np.testing.assert_allclose(within_limits(ROBOT, brought), brought, atol=1e-12)
    cross = q[..., 0] * brought[..., 1] - q[..., 1] * brought[..., 0]
    np.testing.assert_allclose(cross, 0.0, atol=1e-12)  # bends keep their direction
