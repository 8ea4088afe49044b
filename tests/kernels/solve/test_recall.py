"""The nearest poses, against a sort of all, and how far configurations are apart, against NumPy."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.solve.recall import ANGLE_WEIGHT, compare, recall
from sinuous.problem.target import target_table
from sinuous.solver.shapes import poses_of

ROBOT = sn.Robot.uniform(3, (0.5, 1.5), max_bend=2.5)
RNG = np.random.default_rng(0)
SHAPES = np.concatenate([RNG.uniform(-2, 2, (40, 3, 2)), RNG.uniform(0.5, 1.5, (40, 3, 1))], axis=2)
POSES = poses_of(ROBOT, SHAPES)


def apart(target: sn.Target) -> np.ndarray:
    pose = POSES[:, -1 if target.segment is None else target.segment - 1]
    found = np.zeros(len(pose))
    if target.position is not None:
        found += (((pose[:, 9:] - target.position) / ROBOT.mean_length) ** 2).sum(axis=1)
    if target.direction is not None:
        found += ANGLE_WEIGHT**2 * ((pose[:, 2:9:3] - target.direction) ** 2).sum(axis=1)
    if target.rotation is not None:
        found += ANGLE_WEIGHT**2 * ((pose[:, :9].reshape(-1, 3, 3) - target.rotation) ** 2).sum(axis=(1, 2)) / 2
    return found


@pytest.mark.parametrize("count", [1, 5, 40])
@pytest.mark.parametrize("first", [0, 25, 40])
def test_the_nearest_of_the_candidates_come_in_order(count: int, first: int) -> None:
    tip = ROBOT.tip(SHAPES[7])
    one = sn.Target(tip[:3, 3], direction=tip[:3, 2]), sn.Target((0.1, 0.2, 1.0), segment=2)
    other = sn.Target(tip[:3, 3], rotation=tip[:3, :3]), sn.Target((0.3, -0.2, 1.0), segment=2)
    rows = np.stack([target_table(ROBOT, targets) for targets in (one, other)])
    likely = np.stack([RNG.permutation(first) for _ in range(2)])
    found = np.empty((2, count), np.int64)
    recall(POSES, rows, ROBOT.mean_length, likely, first, found, np.empty(count))
    for targets, numbers in zip((one, other), found, strict=True):
        expected = sum(apart(target) for target in targets)
        np.testing.assert_array_equal(numbers, np.argsort(expected, kind="stable")[:count])


def test_configurations_are_as_far_apart_as_their_numbers() -> None:
    scales, found = np.array([1.0, 2.0, 0.5]), np.empty((8, 5))
    others = SHAPES.reshape(8, 5, 3, 3)
    compare(SHAPES[:8], others, scales, found)
    expected = np.abs((SHAPES[:8, None] - others) / scales).max(axis=(2, 3))
    np.testing.assert_allclose(found, expected, rtol=1e-14)
