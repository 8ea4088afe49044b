"""The pull of targets: derivatives against differences, and nothing where all is met."""

import numpy as np
import pytest

from sinuous import Problem, Robot, Target, pose
from sinuous.solution.binding.pull import pull_of
from tests.helpers import Floats, random_pose

ROBOT = Robot.uniform(
    3, (0.5, 1.0), 2.5, base=pose((1, 2, 3), direction=(0, 1, 1)), tool=pose((0.1, 0, 0.2), direction=(1, 0, 1))
)


def targets(seed: int) -> list[Target]:
    place = random_pose(np.random.default_rng(seed))
    whole, pointing = Target(place[:3, 3], rotation=place[:3, :3]), Target(place[:3, 3], direction=place[:3, 2])
    return [whole, pointing, Target(direction=place[:3, 0]), Target(place[:3, 3], segment=2)]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("kind", range(4))
def test_the_pull_is_the_slope_of_the_residual(seed: int, kind: int) -> None:
    rng = np.random.default_rng(seed)
    q = np.column_stack([rng.normal(0.0, 0.6, (3, 2)), rng.uniform(0.5, 1.0, 3)])
    problem = Problem(ROBOT, targets(seed)[kind])

    def merit(x: Floats) -> float:
        return 0.5 * float((pull_of(problem, x).misses ** 2).sum())

    pull, h = pull_of(problem, q), 1e-6
    steps = h * np.eye(9).reshape(9, 3, 3)
    slope = [(merit(q - step) - merit(q + step)) / (2.0 * h) for step in steps]
    np.testing.assert_allclose(pull.misses @ pull.rows, slope, atol=1e-7)
    assert not pull.met


def test_what_is_met_does_not_pull() -> None:
    q = np.array([[0.3, 0.1, 0.7], [-0.5, 0.2, 0.8], [0.1, 0.9, 0.6]])
    tip = ROBOT.tip(q)
    pull = pull_of(Problem(ROBOT, Target(tip[:3, 3], rotation=tip[:3, :3])), q)
    assert pull.met
    np.testing.assert_allclose(pull.misses, 0.0, atol=1e-12)
