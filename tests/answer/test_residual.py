"""The pull of targets: derivatives against differences, and nothing where all is met."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sinuous import Problem, Robot, Target, pose
from sinuous.answer.residual import residual_of, rotation_between
from tests.cases import with_each
from tests.helpers import Floats, random_pose

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
