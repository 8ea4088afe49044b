"""Preferences: what is solved stays solved, the cost falls, and at the end no small motion lowers it."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.kernels.solve.preferences import prefer
from sinuous.kernels.step.states import workspace_size
from sinuous.kernels.tables import MAX_ITERATIONS
from sinuous.model.robot import Robot, robot_group
from sinuous.problem.problem import Preferences, Problem, settings_group
from sinuous.problem.target import Target
from tests.helpers import Floats

ROBOT = Robot.uniform(5, (0.7, 1.3), 2.5, radius=0.05)
UNIT = 1.0
"""Mean length of a segment."""

PREFERENCES = (Preferences(bends=1.0), Preferences(start=1.0), Preferences(start=0.5, bends=2.0))


def shape(seed: int, size: float = 0.5) -> Floats:
    rng = np.random.default_rng(seed)
    angle, bend = rng.uniform(-math.pi, math.pi, 5), size * 2.5 * np.sqrt(rng.random(5))
    return np.stack([bend * np.cos(angle), bend * np.sin(angle), rng.uniform(0.85, 1.15, 5)], axis=-1)


def problem_at(q: Floats, scene: Any = None) -> Problem:
    tip = ROBOT.tip(q)
    return Problem(ROBOT, Target(tip[:3, 3], direction=tip[:3, 2]), scene)


def preferred(
    problem: Problem, wish: Preferences, q: Floats, reference: Floats, seconds: float = 30.0, most: int = 60
) -> tuple[Floats, int, float, float, float, float]:
    settings = settings_group(ROBOT, problem.tolerance, wish)
    settings[MAX_ITERATIONS] = most
    size = workspace_size(len(ROBOT), 0, len(problem.scene), len(problem.targets)) + len(robot_group(ROBOT))
    best = q.copy()
    proved = 0.125, 0.25, 0.5, 0.75, seconds  # no values that a solve would give
    group = problem.scene.group.copy()
    told = prefer(robot_group(ROBOT), group, settings, problem.rows.copy(), reference, proved, np.empty(size), best)
    return best, *told[:-1]


def free_gradient(wish: Preferences, q: Floats, reference: Floats) -> float:
    """Size of the part of the gradient of the cost along which the target is met, and lengths at a limit stay there."""
    jacobian = ROBOT.jacobian(q)
    across = np.linalg.svd(ROBOT.tip(q)[None, :3, 2])[2][1:]
    lines = np.concatenate([jacobian[3:], across @ jacobian[:3]])
    away = wish.start * (q - reference) / [1.0, 1.0, UNIT**2] + wish.bends * q * [1.0, 1.0, 0.0]
    free = np.ones_like(q, bool)
    free[:, 2] = np.minimum(ROBOT.limits[:, 1] - q[:, 2], q[:, 2] - ROBOT.limits[:, 0]) > 1e-6
    lines, left = lines[:, free.ravel()], away[free]
    return float(np.linalg.norm(left - np.linalg.pinv(lines) @ (lines @ left)))


@pytest.mark.parametrize(
    ("wish", "share", "steps"), [*zip(PREFERENCES, (0.002, 0.01, 0.01), (40, 10, 10), strict=True)], ids=repr
)
def test_in_the_end_hardly_a_small_motion_is_better(wish: Preferences, share: float, steps: float) -> None:
    """What the targets and limits leave free of the gradient of the cost becomes small, in a few steps."""
    count = []
    for seed in range(12):
        q, reference = shape(seed, 0.3), shape(seed + 1, 0.3)
        best, used, *_ = preferred(problem_at(q), wish, q, reference, most=300)
        assert free_gradient(wish, best, reference) < share * free_gradient(wish, q, reference)
        count.append(used)
    assert np.mean(count) < steps


def test_what_is_not_solved_is_not_taken() -> None:
    """A configuration that misses its target by far cannot be proved: it comes back as it was, with what was told."""
    q = shape(3)
    problem = Problem(ROBOT, Target((0.0, 0.0, 99.0)))
    best, _, *kept = preferred(problem, PREFERENCES[0], q, q)
    np.testing.assert_array_equal(best, q)
    assert kept == [0.125, 0.25, 0.5, 0.75]
