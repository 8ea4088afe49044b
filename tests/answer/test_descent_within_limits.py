"""Where the pull of targets and limits comes to rest: within the limits, and no farther from the targets."""

import numpy as np
import pytest

from sinuous import Problem, Robot, Target, pose
from sinuous.answer.residual import descend_within_limits, residual_of
from sinuous.model.limits import nonnegative_least_squares
from tests.cases import with_each
from tests.helpers import Floats, random_pose


def shape(rng: np.random.Generator, segments: int) -> Floats:
    return np.column_stack([rng.normal(0.0, 0.6, (segments, 2)), rng.uniform(0.5, 1.0, segments)])


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_it_is_no_farther_and_within_the_limits(seed: int, unit: float) -> None:
    rng = np.random.default_rng(seed)
    robot = Robot.uniform(4, (0.5 * unit, unit), 1.5, base=pose((1, 2, 3), direction=(0, 1, 1)))
    place = random_pose(rng)
    problem = Problem(robot, Target(5.0 * unit * place[:3, 3], direction=place[:3, 2]))
    before = shape(rng, 4) * [0.5, 0.5, unit]
    after = descend_within_limits(problem, before)
    assert all(limit.slack >= -1e-9 * unit for limit in robot.limit_set.sides(after))
    assert np.linalg.norm(residual_of(problem, after).value) <= np.linalg.norm(residual_of(problem, before).value)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("off", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("segments", [2, 8])
def test_the_last_digits_are_no_trouble(seed: int, off: float, segments: int) -> None:
    rng = np.random.default_rng(seed)
    robot, q = Robot.uniform(segments, (0.5, 1.0), 2.5), shape(rng, segments)
    tip = robot.tip(q + off * rng.normal(size=q.shape))
    problem = Problem(robot, Target(tip[:3, 3], rotation=tip[:3, :3]))
    misses = np.linalg.norm(residual_of(problem, descend_within_limits(problem, q)).value)
    assert misses <= np.linalg.norm(residual_of(problem, q).value)


def optimal(system: Floats, wanted: Floats, x: Floats, slack: float) -> None:
    """Karush, Kuhn and Tucker: the residual pulls no coefficient up, and none down that is above zero."""
    pull = system.T @ (wanted - system @ x)
    assert np.all(x >= 0.0)
    assert np.all(pull <= slack)
    np.testing.assert_allclose(pull * x, 0.0, atol=slack)


@with_each("seed", range(10))
def test_the_residual_balances(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system, wanted = rng.normal(size=(7, 12)), rng.normal(size=7)
    optimal(system, wanted, nonnegative_least_squares(system, wanted), 1e-9)
