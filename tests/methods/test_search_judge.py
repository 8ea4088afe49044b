import math
from typing import Any

import numpy as np
import pytest

from benchmarks.problems import clutter, random_configurations
from sinuous.answer.verification import verify
from sinuous.kernels.body.self_pairs import SPAN_WIDTH
from sinuous.kernels.packing import pose_row
from sinuous.kernels.tables import ARC, CODE, FAILED, MERIT, OUT_OF_REACH, RECORD_WIDTH, SOLVED, SOURCE
from sinuous.methods import search as common
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_problem
from tests.kernels.workspace import make_clock


def checker(problem: Problem) -> tuple[Any, Any]:
    frames = np.zeros((len(problem.robot) + 1, 12))
    frames[0] = pose_row(problem.robot.base)
    obstacles = np.zeros(len(problem.scene), np.int64)
    spans = np.zeros((len(problem.robot) + 1, SPAN_WIDTH))
    own = kernel_problem(problem.robot, problem.targets, problem.scene, problem.tolerance)
    return own, common.Check(frames, obstacles, make_clock(), spans)


def judged(problem: Problem, q: Floats) -> tuple[int, float, float, float, float, bool, float]:
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
            target = Target(tip[:3, 3] + [move, 0.0, 0.0], rotation=tip[:3, :3])
            problem = Problem(robot, target, drawn.scene)
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


def test_several_targets_count_by_the_worst() -> None:
    robot = Robot.uniform(3, (0.8, 1.2), 2.0)
    q = np.array([[0.3, 0.1, 1.0]] * 3)
    ends = robot.forward(q)
    targets = [
        Target(ends[0, :3, 3] + [0.0, 0.2, 0.0], segment=1),
        Target(ends[2, :3, 3], direction=ends[1, :3, 2]),
    ]
    _, off, turn, clearance, _, over, _ = judged(Problem(robot, targets), q)
    assert off == pytest.approx(0.2)
    assert turn == pytest.approx(math.hypot(0.3, 0.1), rel=1e-6)
    assert clearance == math.inf
    assert not over


def test_curvature_and_actuators_are_limits_too() -> None:
    from sinuous.model.actuators import Tendons

    q = np.array([[0.9, 0.0, 1.0]] * 2)
    for robot, name in (
        (Robot.uniform(2, (0.8, 1.2), 2.0, max_curvature=0.8), "curvature"),
        (Robot.uniform(2, 1.0, 2.0, tendons=Tendons(3, radius=0.1, displacement=(-0.05, 0.05))), "actuator"),
        (Robot.uniform(2, (0.8, 1.2), 0.7), "bend"),
        (Robot.uniform(2, (0.2, 0.9), 2.0), "length"),
    ):
        problem = Problem(robot, Target(robot.tip(q)[:3, 3]))
        code, *_, over, merit = judged(problem, q)
        assert (code, over) == (FAILED, True)
        assert merit > 1e-6
        assert {limit for limit, _, _ in robot.violations(q)} == {name}
        straight = np.array([[0.0, 0.0, 0.85 if name == "length" else 1.0]] * 2)
        assert robot.violations(straight) == []
        assert judged(Problem(robot, Target(robot.tip(straight)[:3, 3])), straight)[0] == SOLVED


def empty_answer(segments: int) -> common.Answer:
    """An answer to which nothing was offered yet."""
    record = np.zeros(RECORD_WIDTH)
    record[CODE], record[MERIT] = FAILED, math.inf
    return common.Answer(np.zeros((segments, 3)), record)


def test_the_best_offer_is_kept() -> None:
    robot = Robot.uniform(2, (0.8, 1.2), 2.0)
    right = np.array([[0.5, 0.2, 1.0]] * 2)
    problem = Problem(robot, Target(robot.tip(right)[:3, 3]), Scene([Sphere((5.0, 0.0, 0.0), 1.0)]))
    inner, check = checker(problem)
    answer = empty_answer(2)
    broken, far, near = right.copy(), right.copy(), right.copy()
    broken[0, 0], far[0, 0], near[0, 0] = np.nan, 1.0, 0.6
    offers = ((broken, False), (far, False), (near, False), (far, False), (right, True), (near, False))
    for (q, accepted), kept in zip(offers, (None, far, near, near, right, right), strict=True):
        assert common.offer(inner, check, q, ARC, answer) == accepted
        if kept is not None:
            np.testing.assert_array_equal(answer.best, kept)
    assert (answer.record[CODE], answer.record[SOURCE]) == (SOLVED, ARC)


def test_what_is_proved_impossible_stays_so_until_something_is_solved() -> None:
    robot = Robot.uniform(2, (0.8, 1.2), 2.0)
    right = np.array([[0.5, 0.2, 1.0]] * 2)
    inner, check = checker(Problem(robot, Target(robot.tip(right)[:3, 3])))
    answer = empty_answer(2)
    answer.record[CODE] = OUT_OF_REACH
    assert not common.offer(inner, check, right * 0.9, ARC, answer)
    assert answer.record[CODE] == OUT_OF_REACH
    assert common.offer(inner, check, right, ARC, answer)
    assert answer.record[CODE] == SOLVED
