"""The search of every method but our own: its check of answers, and the starts that it follows."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from benchmarks.problems import random_configurations
from benchmarks.wild.worlds import clutter
from sinuous.answer.verification import verify
from sinuous.kernels.body.self_pairs import SPAN_WIDTH
from sinuous.kernels.packing import pose_row
from sinuous.kernels.tables import FAILED, SOLVED
from sinuous.methods import search as common
from tests.helpers import Floats, kernel_problem
from tests.kernels.workspace import make_clock


def checker(problem: sn.Problem) -> tuple[Any, Any]:
    frames = np.zeros((len(problem.robot) + 1, 12))
    frames[0] = pose_row(problem.robot.base)
    obstacles = np.zeros(len(problem.scene), np.int64)
    spans = np.zeros((len(problem.robot) + 1, SPAN_WIDTH))
    own = kernel_problem(problem.robot, problem.targets, problem.scene, problem.tolerance)
    return own, common.Check(frames, obstacles, make_clock(), spans)


def judged(problem: sn.Problem, q: Floats) -> tuple[int, float, float, float, float, bool, float]:
    result: tuple[int, float, float, float, float, bool, float] = common.finish(*checker(problem), q)
    return result


def test_the_check_agrees_with_the_independent_one() -> None:
    """Random robots of all sorts among obstacles of all kinds; targets met, nearly met, and missed."""
    solved = blocked = bound = missed = 0
    for seed in range(10):
        drawn = clutter(seed, 4)
        robot, rng = drawn.robot, np.random.default_rng(seed)
        for q in random_configurations(robot, 4, rng):
            wild = q * rng.choice([1.0, 1.0, 1.3])
            tip = robot.tip(wild)
            move = rng.choice([0.0, 0.9, 1.1]) * 1e-4 * robot.mean_length
            target = sn.Target(tip[:3, 3] + [move, 0.0, 0.0], rotation=tip[:3, :3])
            problem = sn.Problem(robot, target, drawn.scene)
            code, off, turn, clearance, _, over, merit = judged(problem, wild)
            check = verify(problem, wild)
            assert off == pytest.approx(check.position_error, abs=1e-9 * robot.mean_length)
            assert turn == pytest.approx(check.angle_error, abs=1e-6)
            assert over == (check.excess > 1e-9)
            if code == SOLVED:
                assert check.ok
                assert clearance <= check.clearance + 1e-9
                solved += 1
            elif code == FAILED:
                assert not check.ok or not check.clearance > 0.0
                assert merit > 0.0
            blocked += clearance < 0.0
            bound += over
            missed += off > (problem.tolerance.position or 0.0)
    assert min(solved, blocked, bound, missed) > 3


def test_starts_are_those_given_then_own_ones_until_one_is_solved_or_time_is_over() -> None:
    robot = sn.Robot.uniform(2, (0.8, 1.2), 2.0, radius=0.1)
    q = np.array([[0.5, 0.2, 1.0]] * 2)
    met, missed, far = sn.Target(robot.tip(q)[:3, 3]), sn.Target((0.3, 0.0, 1.0)), sn.Target((0.0, 0.0, 3.0))
    solver = sn.Solver(robot, method=sn.methods.Dls(iterations=1), max_starts=6, time=60.0)
    for target, initial, starts in ((met, q, 1), (missed, None, 6), (missed, q, 6), (far, None, 1), (far, q, 2)):
        found = solver.solve(target, initial=initial)
        assert found.starts == starts
        assert found.solved == (target is met)
    late = sn.Solver(robot, method=sn.methods.Dls(iterations=1), time=1e-9).solve(missed)
    assert (late.status, late.starts) == (sn.Status.TIME_LIMIT, 1)
