"""From configurations to links and back, and the end that a tool asks for."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from sinuous.kernels.packing import pose_row
from sinuous.kernels.problem import Problem
from sinuous.methods.fabrik import links as fabrik
from sinuous.methods.fabrik.links import STEEPEST
from sinuous.model.robot import Robot
from sinuous.problem.target import Target
from tests.cases import with_each
from tests.helpers import Floats, as_matrix, expm_chain, frames_of, random_pose, skew, vec
from tests.methods.fabrik.test_links import MIXED, make_chain


def within(robot: Robot, seed: int) -> Floats:
    """Give a configuration within the limits, and within what a section may turn."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(*robot.limits[:, :2].T)
    bend = rng.random(len(robot)) * np.fmin(robot.limits[:, 2], np.fmin(robot.limits[:, 3] * length, STEEPEST))
    angle = rng.uniform(-math.pi, math.pi, len(robot))
    return np.stack([bend * np.cos(angle), bend * np.sin(angle), length], axis=-1)


@with_each("seed", range(20))
def test_a_configuration_within_the_limits_is_taken_over_as_it_is(seed: int) -> None:
    base = random_pose(np.random.default_rng(seed))
    q = within(MIXED, seed)
    chain, frames, found = make_chain(5), frames_of(np.zeros((5, 3)), base), q.copy()
    fabrik.fold(MIXED.limits, chain, frames, seed % 2 == 0, found)
    np.testing.assert_allclose(found, q, atol=1e-15)
    poses = expm_chain(q, base)
    np.testing.assert_allclose(chain.points, [pose[:3, 3] for pose in poses], atol=1e-12)
    np.testing.assert_allclose(chain.tangents, [pose[:3, 2] for pose in poses], atol=1e-12)
    for row, pose in zip(frames, poses, strict=True):
        np.testing.assert_allclose(as_matrix(row[:9].reshape(3, 3), row[9:]), pose, atol=1e-12)
    low, high = (MIXED.limits[:, 0], MIXED.limits[:, 1]) if seed % 2 == 0 else (q[:, 2], q[:, 2])
    np.testing.assert_allclose(chain.low, low)
    np.testing.assert_allclose(chain.high, high)


@pytest.mark.parametrize("pieces", [1, 2, 3])
def test_unfolding_undoes_folding(pieces: int) -> None:
    for seed in range(10):
        rng = np.random.default_rng(seed)
        base = random_pose(rng)
        chain, frames = make_chain(5, pieces, 0.4), frames_of(np.zeros((5, 3)), base)
        folded = within(MIXED, seed) * [0.4, 0.4, 1.0]
        fabrik.fold(MIXED.limits, chain, frames, False, folded)
        found = np.full((5, 3), np.nan)
        fabrik.unfold(chain, frames, found)
        np.testing.assert_allclose(found, folded, atol=1e-12)
        np.testing.assert_allclose(frames[-1], frames_of(folded, base)[-1], atol=1e-12)
        np.testing.assert_allclose(chain.points[-1], frames[-1, 9:], atol=1e-9)


def test_what_the_limits_forbid_is_not_taken_over() -> None:
    for scale in (3.0, 50.0):
        chain, frames = make_chain(5), frames_of(np.zeros((5, 3)))
        q = within(MIXED, 3) * scale
        fabrik.fold(MIXED.limits, chain, frames, True, q)
        assert MIXED.excess(q) <= 1e-12


def test_a_rotation_vector_is_the_exponential_of_its_matrix() -> None:
    rng = np.random.default_rng(0)
    for size in (0.0, 1e-9, 0.3, 2.0, math.pi, 5.0):
        w = rng.normal(size=3)
        w *= size / np.linalg.norm(w)
        np.testing.assert_allclose(np.array(fabrik.rotation_of(vec(w))), expm(skew(w)), atol=1e-13)


def problem_of(target: Target, tool: Floats) -> Any:
    """Give as much of a problem as the goal of the tip needs."""
    values = dict.fromkeys(Problem._fields, 0.0)
    return Problem(**{**values, "tool": pose_row(tool), "targets": target.table.copy()})


@with_each("seed", range(10))
def test_a_tool_at_its_target_asks_for_the_end_where_it_is(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, base = within(MIXED, seed), random_pose(rng)
    frames = frames_of(q, base)
    end = expm_chain(q, base)[-1]
    for tool in (np.eye(4), as_matrix(np.eye(3), [0, 0, 0.7]), random_pose(rng)):
        at = end @ tool
        for direction in (None, at[:3, 2]):
            goal, aim, aimed = fabrik.end_goal(problem_of(Target(at[:3, 3], direction=direction), tool), frames)
            assert aimed == (direction is not None)
            np.testing.assert_allclose(goal, end[:3, 3], atol=1e-12)
            np.testing.assert_allclose(aim, end[:3, 2], atol=1e-12)


@with_each("seed", range(10))
def test_the_end_that_is_asked_for_has_the_tool_at_the_target(seed: int) -> None:
    rng = np.random.default_rng(seed)
    frames = frames_of(within(MIXED, seed), random_pose(rng))
    tool = as_matrix(np.eye(3), [0, 0, 0.7]) if seed % 2 else random_pose(rng)
    place, direction = rng.normal(size=(2, 3))
    direction /= np.linalg.norm(direction)
    goal, aim, aimed = fabrik.end_goal(problem_of(Target(place, direction=direction), tool), frames)
    assert aimed
    # Whatever the roll, the tool's axis and its offset are as far apart as tool and tip are.
    shift = place - np.array(goal)
    assert np.linalg.norm(shift) == pytest.approx(np.linalg.norm(tool[:3, 3]))
    assert np.dot(aim, direction) == pytest.approx(tool[2, 2])
    assert np.dot(aim, shift) == pytest.approx(tool[2, 3])
    assert np.dot(direction, shift) == pytest.approx(tool[:3, 2] @ tool[:3, 3])
