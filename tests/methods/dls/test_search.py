"""Damped least squares: the Jacobian, the damped system, and the limits of a step."""

import numpy as np
import pytest

from sinuous.kernels.step.targets import add_rows
from sinuous.methods.dls import search as dls
from sinuous.packing import pose_row
from sinuous.problem.target import Target
from sinuous.robot.robot import Robot
from tests.helpers import columns_of, frames_of, make_rows, random_pose, vec
from tests.methods.fabrik.test_conversion import within
from tests.methods.fabrik.test_links import MIXED


@pytest.mark.parametrize("seed", range(10))
def test_the_jacobian_is_the_geometric_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    base, tool = random_pose(rng), random_pose(rng)
    robot = Robot(MIXED.segments, base=base, tool=tool)
    q, unit = within(robot, seed), 2.5
    rows = make_rows(5, 6)
    target = Target(rng.normal(size=3), rotation=random_pose(rng)[:3, :3])
    count, _, _ = add_rows(target.table.copy(), 0, frames_of(q, base), pose_row(tool), vec(base[:3, 3]), unit, rows, 0)
    found = np.full((6, 15), np.nan)
    dls.fill_jacobian(robot.limits, columns_of(q, base), rows, count, found)
    scale = robot.limits[:, [5, 5, 6]].ravel()
    turning, moving = robot.jacobian(q)[:3], robot.jacobian(q)[3:] / unit
    np.testing.assert_allclose(found, np.concatenate([moving, turning]) * scale, atol=1e-12)


@pytest.mark.parametrize("count", [1, 3, 5, 6])
def test_the_damped_system_is_solved(count: int) -> None:
    rng = np.random.default_rng(count)
    for mu in (1e-9, 0.1, 10.0):
        jacobian, x = rng.normal(size=(6, 12)), rng.normal(size=6)
        expected = np.linalg.solve(jacobian[:count] @ jacobian[:count].T + mu * np.eye(count), x[:count])
        dls.solve_damped(jacobian, count, mu, np.full((6, 6), np.nan), x)
        np.testing.assert_allclose(x[:count], expected, rtol=1e-9)


def test_a_singular_jacobian_is_no_trouble() -> None:
    """A straight robot cannot move ahead by bending."""
    jacobian, x = np.zeros((6, 6)), np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    dls.solve_damped(jacobian, 6, 0.01, np.zeros((6, 6)), x)
    np.testing.assert_allclose(x, [100.0, 0, 0, 0, 0, 0])
