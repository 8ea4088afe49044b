"""Derivatives of answers that preferences have chosen: against differences of minima that are found in another way."""

import numpy as np
import pytest
from scipy.optimize import root

import sinuous as sn
from benchmarks.derivatives import ALL, SHAPES, Tangent, preferred, question, random_tangent
from sinuous.answer.residual import residual_of
from sinuous.base.checks import Floats
from sinuous.kernels.packing import scales_of

TOLERANCE = 1e-6
STEP = 1e-4
"""Of the differences: rad, and mean lengths of the robot."""


def minimum(problem: sn.Problem, prefer: sn.Preferences, start: Floats, near: Floats) -> Floats:
    """The nearest zero of the conditions of a minimum (Lagrange), with the limits that are active at `near` kept."""
    scale = scales_of(problem.robot.limits).ravel()
    moves = np.flatnonzero(scale)
    active = [
        i for i, each in enumerate(problem.robot.limit_set.sides(near)) if abs(each.slack) < 1e-6 and not each.fixed
    ]

    def conditions(x: Floats) -> Floats:
        q = near.copy()
        q.ravel()[moves] += scale[moves] * x[: len(moves)]
        ends = residual_of(problem, q)
        listed = list(problem.robot.limit_set.sides(q))
        limits = [listed[i] for i in active]
        rows = np.vstack([ends.jacobian, *(each.gradient.ravel() for each in limits)])
        slope = prefer.start * ((q - start).ravel()[moves] / scale[moves])
        slope += prefer.bends * (q * [1.0, 1.0, 0.0]).ravel()[moves] * scale[moves]
        slope -= (rows[:, moves] * scale[moves]).T @ x[len(moves) :]
        left = [each.slack / problem.robot.mean_length for each in limits]
        return np.concatenate([slope, ends.value, left])

    count = len(moves) + len(residual_of(problem, near).value) + len(active)
    found = root(conditions, np.zeros(count), tol=1e-15)
    assert np.abs(found.fun).max() < 1e-10
    whole = near.copy()
    whole.ravel()[moves] += scale[moves] * found.x[: len(moves)]
    return whole


def differences(found: sn.Solution, prefer: sn.Preferences, start: Floats, way: Tangent) -> Floats:
    """Central differences of minima along a tangent, of two steps: together exact to the fourth order."""
    derivative = found.derivative(ALL)
    fixed = scales_of(found.problem.robot.limits).ravel()[2::3] == 0.0
    ends = []
    for h in (STEP, -STEP, 0.5 * STEP, -0.5 * STEP):
        asked, _ = question(found, way, h)
        near, reference = derivative.configuration.copy(), start + h * way["initial"].reshape(-1, 3)
        near[fixed, 2] += h * way["lengths"][fixed]
        reference[fixed, 2] = near[fixed, 2]
        ends.append(minimum(sn.Problem(asked.robot, asked.targets), prefer, reference, near))
    change: Floats = (4.0 * (ends[2] - ends[3]) / STEP - (ends[0] - ends[1]) / (2.0 * STEP)) / 3.0
    return change


@pytest.mark.parametrize("shape", list(SHAPES))
def test_minima_that_move_agree_with_differences(shape: str) -> None:
    regular = 0
    for seed in range(3):
        found, prefer, start = preferred(shape, np.random.default_rng([seed, list(SHAPES).index(shape)]))
        if not found.solved:
            continue
        derivative, way = found.derivative(ALL), random_tangent(found, np.random.default_rng(seed))
        if not derivative.regular:
            continue
        regular += 1
        scale = np.array([1.0, 1.0, found.problem.robot.mean_length])
        motion, wanted = derivative.jvp(way) / scale, differences(found, prefer, start, way) / scale
        assert np.linalg.norm(motion - wanted) < TOLERANCE * max(1.0, float(np.linalg.norm(wanted))), seed
    assert regular > 1


def test_what_pushes_is_active_and_not_weak() -> None:
    robot = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0)
    solver = sn.Solver(robot, prefer=sn.Preferences(bends=1.0))
    derivative = solver.solve(sn.Target((1.0, 0.4, 2.8))).derivative()
    assert derivative.regular
    assert {each.constraint for each in derivative.active} == {"length"}
    assert derivative.weak == ()
    np.testing.assert_allclose(derivative.tip["target"][3:], np.eye(3), atol=1e-9)


def test_where_the_start_is_not_known_or_clearance_is_missing_it_is_not_regular() -> None:
    robot, target = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0, radius=0.02), sn.Target((1.0, 0.4, 3.2))
    assert not sn.solve(robot, target, prefer=sn.Preferences(start=1.0)).derivative().regular
    scene, start = [sn.Sphere((0.0, 1.0, 1.5), 0.3)], [[0.3, 0.0, 1.0]] * 4
    wishes = (sn.Preferences(start=1.0, clearance=each) for each in (0.01, 5.0))
    found = [sn.solve(robot, target, scene, prefer=each, initial=start) for each in wishes]
    assert [each.derivative().regular for each in found] == [True, False]
