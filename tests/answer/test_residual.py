"""The pull of targets: derivatives against differences, and nothing where all is met.

Where the pull of targets and limits comes to rest: within the limits, and no farther from the targets.
"""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sinuous import Problem, Robot, Target, pose
from sinuous.answer.residual import descend_within_limits, residual_of, rotation_between
from sinuous.model.limits import nonnegative_least_squares
from tests.helpers import Floats, random_pose, with_each

ROBOT = Robot.uniform(
    3, (0.5, 1.0), 2.5, base=pose((1, 2, 3), direction=(0, 1, 1)), tool=pose((0.1, 0, 0.2), direction=(1, 0, 1))
)


def targets(seed: int) -> list[Target]:
    place = random_pose(np.random.default_rng(seed))
    whole, pointing = Target(place[:3, 3], rotation=place[:3, :3]), Target(place[:3, 3], direction=place[:3, 2])
    return [whole, pointing, Target(direction=place[:3, 0]), Target(place[:3, 3], segment=2)]


@with_each("seed", range(6))
@with_each("kind", range(4))
def test_the_pull_is_the_slope_of_the_residual(seed: int, kind: int) -> None:
    rng = np.random.default_rng(seed)
    q = np.column_stack([rng.normal(0.0, 0.6, (3, 2)), rng.uniform(0.5, 1.0, 3)])
    problem = Problem(ROBOT, targets(seed)[kind])

    def merit(x: Floats) -> float:
        return 0.5 * float((residual_of(problem, x).value ** 2).sum())

    residual, h = residual_of(problem, q), 1e-6
    steps = h * np.eye(9).reshape(9, 3, 3)
    slope = [(merit(q - step) - merit(q + step)) / (2.0 * h) for step in steps]
    np.testing.assert_allclose(residual.value @ residual.jacobian, slope, atol=1e-7)
    assert not residual.met


def directions(seed: int) -> tuple[Floats, Floats]:
    pair = np.random.default_rng(seed).normal(size=(2, 3))
    one, other = pair / np.linalg.norm(pair, axis=1, keepdims=True)
    return one, other


@with_each("seed", range(10))
@with_each("off", [0.0, 1e-15, 1e-10, 1e-7])
def test_opposite_directions_are_half_a_turn_apart(seed: int, off: float) -> None:
    one, across = directions(seed)
    other = -one + off * np.cross(one, across)
    turn = rotation_between(one, other / np.linalg.norm(other))
    assert np.linalg.norm(turn) == pytest.approx(math.pi, abs=2.0 * off + 1e-12)
    np.testing.assert_allclose(Rotation.from_rotvec(turn).apply(one), other, atol=2e-9)


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
