import math
from typing import Any

import numpy as np
import pytest

from benchmarks.problems import clutter, random_configurations
from sinuous.kernels.solve import judge as common
from sinuous.kernels.step.states import Problem as KernelProblem
from sinuous.kernels.tables import (
    ANGLE_ERROR,
    ARC,
    CODE,
    FAILED,
    GIVEN,
    ITERATIONS,
    LATE,
    MERIT,
    OUT_OF_REACH,
    POSITION_ERROR,
    RANDOM,
    SECONDS,
    SOLVED,
    STARTS,
    TARGET_BLOCKED,
)
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.problem.tolerance import Tolerance
from sinuous.robot.robot import Robot
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from sinuous.solution.verification import verify
from tests.helpers import Floats, kernel_scene


def kernel_problem(problem: Problem) -> KernelProblem:
    """The tables as kernels take them; put together here, because no kernel can return an array."""
    robot = problem.robot
    return KernelProblem(
        robot.limits.copy(),
        robot.actuation.copy(),
        robot.base_row.copy(),
        robot.tool_row.copy(),
        kernel_scene(problem.scene),
        problem.rows,
        robot.mount,
        robot.mean_length,
        0.0,
        problem.tolerance.position,
        problem.tolerance.angle,
        0,
        0,
    )


def checker(problem: Problem) -> tuple[Any, Any]:
    frames = np.zeros((len(problem.robot) + 1, 12))
    frames[0] = problem.robot.base_row
    obstacles = np.zeros(len(problem.scene), np.int64)
    return kernel_problem(problem), common.Check(frames, obstacles, np.zeros(2, np.int64))


def judged(problem: Problem, q: Floats) -> tuple[int, float, float, float, bool, float]:
    result: tuple[int, float, float, float, bool, float] = common.finish(*checker(problem), q)
    return result


def test_the_check_agrees_with_the_independent_one() -> None:
    """Random robots of all sorts among obstacles of all kinds; targets met, nearly met, and missed."""
    solved = blocked = bound = missed = 0
    for seed in range(30):
        drawn = clutter(seed, 4)
        robot, rng = drawn.robot, np.random.default_rng(seed)
        for q in random_configurations(robot, 4, rng):
            wild = q * rng.choice([1.0, 1.0, 1.3])
            tip = robot.tip(wild)
            move = rng.choice([0.0, 0.9, 1.1]) * 1e-4 * robot.mean_length
            target = Target(tip[:3, 3] + [move, 0.0, 0.0], rotation=tip[:3, :3])
            problem = Problem(robot, target, drawn.scene)
            code, off, turn, clearance, over, merit = judged(problem, wild)
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
    assert min(solved, blocked, bound, missed) > 5


def test_several_targets_count_by_the_worst() -> None:
    robot = Robot.uniform(3, (0.8, 1.2), 2.0)
    q = np.array([[0.3, 0.1, 1.0]] * 3)
    ends = robot.forward(q)
    targets = [
        Target(ends[0, :3, 3] + [0.0, 0.2, 0.0], segment=1),
        Target(ends[2, :3, 3], direction=ends[1, :3, 2]),
    ]
    _, off, turn, clearance, over, _ = judged(Problem(robot, targets), q)
    assert off == pytest.approx(0.2)
    assert turn == pytest.approx(math.hypot(0.3, 0.1), rel=1e-6)
    assert clearance == math.inf
    assert not over


def test_curvature_and_actuators_are_limits_too() -> None:
    from sinuous.robot.actuators import Tendons

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


def test_the_best_offer_is_kept() -> None:
    robot = Robot.uniform(2, (0.8, 1.2), 2.0)
    right = np.array([[0.5, 0.2, 1.0]] * 2)
    problem = Problem(robot, Target(robot.tip(right)[:3, 3]), Scene([Sphere((5.0, 0.0, 0.0), 1.0)]))
    inner, check = checker(problem)
    best, record = np.zeros((2, 3)), np.zeros(10)
    deadline, most = common.begin(inner, check, np.empty((0, 2, 3)), 3, 9, 1.0, best, record)
    assert most == 9
    assert deadline > record[SECONDS]
    np.testing.assert_array_equal(best[:, 2], 1.0)
    broken, far, near = right.copy(), right.copy(), right.copy()
    broken[0, 0], far[0, 0], near[0, 0] = np.nan, 1.0, 0.6
    offers = ((broken, False), (far, False), (near, False), (far, False), (right, True))
    for (q, accepted), kept in zip(offers, (None, far, near, near, right), strict=True):
        assert common.offer(inner, check, q, ARC, best, record) == accepted
        if kept is not None:
            np.testing.assert_array_equal(best, kept)
    common.end(inner, check, 7, 2, True, best, record)
    assert (record[CODE], record[ITERATIONS], record[STARTS]) == (SOLVED, 7, 2)
    assert 0.0 <= record[SECONDS] < 60.0


def test_nothing_offered_is_the_straight_robot_and_a_failure() -> None:
    robot = Robot.uniform(2, (0.8, 1.2), 2.0)
    inner, check = checker(Problem(robot, Target((0.0, 0.0, 2.0))))
    for late, code in ((False, FAILED), (True, LATE)):
        best, record = np.zeros((2, 3)), np.zeros(10)
        common.begin(inner, check, np.empty((0, 2, 3)), 0, 0, 1.0, best, record)
        common.end(inner, check, 0, 0, late, best, record)
        assert record[CODE] == code
        assert np.isfinite(record[[POSITION_ERROR, ANGLE_ERROR, MERIT]]).all()


def test_the_impossible_is_said_and_hardly_tried() -> None:
    robot = Robot.uniform(2, (0.8, 1.2), 2.0, radius=0.1)
    for target, scene, code in (
        (Target((0.0, 0.0, 3.0)), Scene(), OUT_OF_REACH),
        (Target((0.0, 1.0, 1.0)), Scene([Sphere((0.0, 1.0, 1.0), 0.3)]), TARGET_BLOCKED),
    ):
        inner, check = checker(Problem(robot, target, scene, Tolerance(1e-3, 1e-3)))
        best, record = np.zeros((2, 3)), np.zeros(10)
        _, most = common.begin(inner, check, np.empty((1, 2, 3)), 0, 50, 1.0, best, record)
        assert most == 2
        common.offer(inner, check, np.array([[0.1, 0.0, 1.0]] * 2), ARC, best, record)
        common.end(inner, check, 0, 0, False, best, record)
        assert record[CODE] == code


def test_starts_are_given_then_the_arc_then_scattered_within_limits() -> None:
    robot = Robot.uniform(3, (0.8, 1.2), 2.0)
    inner, check = checker(Problem(robot, Target((0.5, 1.0, 2.0))))
    given = np.array([[[0.1, 0.2, 1.1]] * 3])
    q = np.zeros((3, 3))
    kinds = []
    for index in range(6):
        kinds.append(common.begin_from(inner, check, given, index, 0, q))
        assert robot.excess(q) <= 1e-12
        if index == 0:
            np.testing.assert_array_equal(q, given[0])
        if index > 1:  # turned about the base to the target's side
            tip = robot.tip(q)[:3, 3]
            assert math.atan2(tip[1], tip[0]) == pytest.approx(math.atan2(1.0, 0.5), abs=1e-9)
    assert kinds == [GIVEN, ARC, *[RANDOM] * 4]
