"""Damped least squares: the Jacobian, the damped system, the limits of a step, and the whole method."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.packing import pose_row
from sinuous.kernels.step.targets import add_rows
from sinuous.methods import dls
from sinuous.methods.dls import Dls
from tests.cases import with_each
from tests.helpers import columns_of, frames_of, make_rows, random_pose, refused, vec
from tests.methods import laws
from tests.methods.fabrik.test_links import MIXED
from tests.methods.fabrik.test_links_conversion import within


@with_each("seed", range(10))
def test_the_jacobian_is_the_geometric_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    base, tool = random_pose(rng), random_pose(rng)
    robot = sn.Robot(MIXED.segments, base=base, tool=tool)
    q, unit = within(robot, seed), 2.5
    rows = make_rows(5, 6)
    target = sn.Target(rng.normal(size=3), rotation=random_pose(rng)[:3, :3])
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


def test_the_papers_four_poses() -> None:
    solver = sn.Solver(laws.ARM, method="dls", tolerance=sn.Tolerance(1e-3, 1e-4))
    assert laws.solved_and_verified(solver, laws.PAPER) == 4


@pytest.mark.parametrize("kind", ["position", "direction", "rotation"])
def test_reachable_targets(kind: str) -> None:
    solver = sn.Solver(laws.ARM, method="dls")
    assert laws.solved_and_verified(solver, laws.tip_targets(laws.ARM, 60, 2.0, kind=kind)) == 60


def test_a_direction_alone_and_a_tool() -> None:
    robot = sn.Robot(laws.ARM.segments, tool=sn.pose((3, 4, 20), direction=(1, 0, 1)))
    solver = sn.Solver(robot, method="dls")
    assert laws.solved_and_verified(solver, [sn.Target(direction=(1, 2, 0.5)), sn.Target(direction=(0, 0, -1))]) == 2
    assert laws.solved_and_verified(solver, laws.tip_targets(robot, 40)) == 40


def test_a_batch_is_a_loop() -> None:
    laws.many_are_as_one(sn.Solver(laws.ARM, method="dls"), laws.tip_targets(laws.ARM, 20, 2.4))


def test_limits_and_starts_and_obstacles() -> None:
    laws.keeps_its_limits("dls", laws.LIMITED)
    laws.begins_from_an_initial_configuration("dls")
    laws.does_not_pretend("dls")


def test_a_step_goes_no_farther_than_its_clamp() -> None:
    """Far away and hardly moving: with a small clamp and few steps the tip stays near its start."""
    start = laws.shapes(laws.ARM, 1, 1.0, 0)[0]
    target = sn.Target((200, 0, 0))
    moved = []
    for clamp in (0.01, 0.1):
        solver = sn.Solver(laws.ARM, method=Dls(iterations=1, clamp=clamp, damping=0.0), max_starts=1)
        solution = solver.solve(target, initial=start)
        moved.append(abs(laws.ARM.tip(solution.q)[:3, 3] - laws.ARM.tip(start)[:3, 3]).max())
    assert 0.0 < moved[0] < 0.02 * laws.ARM.mean_length
    assert moved[1] > 5.0 * moved[0]


def test_what_it_cannot_mean_is_refused() -> None:
    refused("damping", lambda: Dls(damping=-1.0))
    refused("clamp", lambda: Dls(clamp=0.0))
    refused("iterations", lambda: Dls(iterations=0))
    solver = sn.Solver(laws.ARM, method="dls")
    refused("target.segment", lambda: solver.solve(sn.Target((0, 0, -100), segment=2)))
    refused("targets", lambda: solver.solve([sn.Target((0, 0, -200)), sn.Target(direction=(0, 0, 1))]))
