"""Random draws: even, repeatable, within their range and the limits."""

from typing import Any

import numpy as np
import pytest

from sinuous.kernels.problem import Problem
from sinuous.methods.monte_carlo import search as monte_carlo
from sinuous.robot.actuators import Tendons
from sinuous.robot.robot import Robot
from tests.helpers import Floats
from tests.methods.fabrik.test_links import MIXED


def drawn(count: int, seed: int) -> Floats:
    state = np.array([seed], np.uint64)
    return np.array([monte_carlo.draw(state) for _ in range(count)])


def test_numbers_are_even_and_repeat_for_a_seed() -> None:
    x = drawn(20_000, 5)
    assert (x >= -1.0).all()
    assert (x < 1.0).all()
    quantiles = np.linspace(0.05, 0.95, 19)
    np.testing.assert_allclose(np.quantile(x, quantiles), 2.0 * quantiles - 1.0, atol=0.03)
    assert abs(np.corrcoef(x[:-1], x[1:])[0, 1]) < 0.03
    np.testing.assert_array_equal(drawn(50, 5), x[:50])
    assert (drawn(50, 6) != x[:50]).all()


def scattered(robot: Robot, q: Floats, share: float, count: int) -> Floats:
    values: dict[str, Any] = dict.fromkeys(Problem._fields, 0.0)
    problem = Problem(**{**values, "limits": robot.limits, "actuation": robot.actuation})
    n = len(robot)
    work = monte_carlo.Work(q.copy(), np.empty((n, 3)), np.empty((n, 3)), np.array([1], np.uint64))
    out = []
    for _ in range(count):
        monte_carlo.scatter(problem, work, share)
        out.append(work.trial.copy())
    return np.stack(out)


@pytest.mark.parametrize("share", [1.0, 0.1, 1e-6])
def test_draws_stay_in_their_range_and_within_the_limits(share: float) -> None:
    middle = np.array([[0.0, 0.0, 0.5 * sum(segment.length)] for segment in MIXED.segments])
    found = scattered(MIXED, middle, share, 300)
    assert MIXED.excess(found) <= 1e-12
    reach = share * np.array([2.0, 3.0, 1.0, 0.0, np.pi])
    assert (np.abs(found[..., :2]) <= reach[:, None] + 1e-12).all()
    spread = 0.5 * share * (MIXED.limits[:, 1] - MIXED.limits[:, 0])
    assert (np.abs(found[..., 2] - middle[:, 2]) <= spread + 1e-12).all()
    # And they fill it.
    assert (np.abs(found[..., 2] - middle[:, 2]).max(axis=0) >= 0.9 * spread).all()
    assert (np.abs(found[..., 0]).max(axis=0) >= 0.5 * reach).all()


def test_draws_keep_the_limits_of_tendons() -> None:
    robot = Robot.uniform(3, (0.8, 1.2), 2.0, tendons=Tendons(count=3, radius=0.1, displacement=(-0.1, 0.1)))
    found = scattered(robot, np.array([[0.0, 0.0, 1.0]] * 3), 1.0, 200)
    assert robot.excess(found) <= 1e-12
    assert np.abs(found[..., :2]).max() > 0.1
