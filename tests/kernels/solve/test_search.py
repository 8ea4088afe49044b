"""The laws of one solve: the order of its starts, its budget, and that many are as one."""

import math
import time
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.answer.verification import verify
from sinuous.kernels.solve.search import search, search_many
from sinuous.kernels.step.states import workspace_size
from sinuous.kernels.tables import (
    ARC,
    FAILED,
    GIVEN,
    LATE,
    OUT_OF_REACH,
    RECORD_WIDTH,
    SOLVED,
    TARGET_BLOCKED,
    Outcome,
    answer_size,
)
from sinuous.model.robot import Robot, robot_group
from sinuous.problem.problem import Problem, settings_group
from sinuous.problem.target import Target
from sinuous.scene.obstacles import Box, Sphere
from tests.helpers import Floats

ROBOT = Robot.uniform(4, (0.8, 1.2), 2.0, radius=0.05)
SCENE = (Sphere((0.6, 0.0, 2.0), 0.4), Box((-1.0, 0.5, 1.5), (0.4, 1.0, 1.0)), Sphere((0.0, -1.2, 2.5), 0.5))
LONG = 30.0


class Groups(NamedTuple):
    """A problem as the entries take it."""

    robot: Floats
    scene: Floats
    settings: Floats
    targets: Floats
    workspace: Floats
    segments: int


def groups(problem: Problem, rows: Any = None) -> Groups:
    robot = problem.robot
    size = workspace_size(len(robot), len(robot.actuation), len(problem.scene), len(problem.targets))
    settings = settings_group(robot, problem.tolerance)
    targets = problem.rows.copy() if rows is None else rows
    return Groups(robot_group(robot), problem.scene.group.copy(), settings, targets, np.empty(size), len(robot))


def solved(
    problem: Problem, own: tuple[int, int] = (0, 40), initial: Any = (), seed: int = 0, seconds: float = LONG
) -> Outcome:
    given = np.array(initial, np.float64).reshape(-1, len(problem.robot), 3)
    it = groups(problem)
    best = np.full((it.segments, 3), np.nan)
    record = search(it.robot, it.scene, it.settings, it.targets, given, (*own, seed, seconds), it.workspace, best)
    return Outcome(best, *record)


def shape(seed: int, robot: Robot = ROBOT) -> Floats:
    rng = np.random.default_rng(seed)
    low, high, bend = robot.limits[:, :3].T
    angle, size = rng.uniform(-math.pi, math.pi, len(robot)), bend * np.sqrt(rng.random(len(robot)))
    return np.stack([size * np.cos(angle), size * np.sin(angle), rng.uniform(low, high)], axis=-1)


def target_at(q: Floats, kind: int = 1, robot: Robot = ROBOT) -> Target:
    tip = robot.tip(q)
    if kind == 0:
        return Target(tip[:3, 3])
    return Target(tip[:3, 3], direction=tip[:3, 2]) if kind == 1 else Target(tip[:3, 3], rotation=tip[:3, :3])


def ok(problem: Problem, q: Floats) -> bool:
    return verify(problem, q).ok


@given(st.integers(0, 10**6), st.integers(1, 7), st.integers(0, 2), st.integers(0, 2))
def test_many_are_one_after_the_other_bit_for_bit(seed: int, count: int, given_each: int, kind: int) -> None:
    shapes = [shape(seed + i) for i in range(count)]
    problems = [Problem(ROBOT, target_at(q, kind), SCENE) for q in shapes]
    initial = np.array([[shape(seed + 99 * i + j) for j in range(given_each)] for i in range(count)])
    initial = initial.reshape(count, given_each, len(ROBOT), 3)
    rows = np.stack([each.rows for each in problems])
    it = groups(problems[0], rows)
    answers = np.full((count, answer_size(len(ROBOT))), np.nan)
    search_many(it.robot, it.scene, it.settings, rows, initial, (0, 8, 3, LONG), it.workspace, answers)
    for own, begun, problem in zip(answers, initial, problems, strict=True):
        alone = solved(problem, (0, 8), begun, 3)
        expected = np.array(alone[1:RECORD_WIDTH], np.float64)
        np.testing.assert_array_equal(own[: RECORD_WIDTH - 1], expected)  # all but the seconds
        np.testing.assert_array_equal(own[RECORD_WIDTH:], alone.q.ravel())


def test_solved_is_solved_and_else_the_limits_are_kept() -> None:
    codes = []
    for seed in range(120):
        problem = Problem(ROBOT, target_at(shape(seed), seed % 3), SCENE)
        found = solved(problem, (0, 1))
        assert ROBOT.excess(found.q) <= 1e-11
        if found.code == SOLVED:
            assert ok(problem, found.q)
            assert found.clearance > 0.0
        else:
            assert not ok(problem, found.q)
        codes.append(found.code)
    assert codes.count(SOLVED) > 60
    assert codes.count(FAILED) > 1


@pytest.mark.parametrize("seed", range(6))
def test_what_is_given_comes_first_and_a_solution_is_its_own_answer(seed: int) -> None:
    problem = Problem(ROBOT, target_at(shape(seed), 0))
    first = solved(problem)
    assert first.code == SOLVED
    again = solved(problem, initial=first.q)
    assert (again.code, again.source, again.iterations, again.starts) == (SOLVED, GIVEN, 0, 1)
    np.testing.assert_array_equal(again.q, first.q)
    # Of two the first that is solved.
    others = solved(problem, initial=[first.q, shape(seed + 1)])
    np.testing.assert_array_equal(others.q, first.q)
    assert others.starts == 1


def test_own_starts_follow_what_is_given_in_vain() -> None:
    """Straight, and the target straight ahead, but too near: no side to bend to, while the arc leads to it."""
    robot = Robot.uniform(3, 1.0, 3.0)
    problem = Problem(robot, Target((0.0, 0.0, 2.0)))
    straight = np.tile([0.0, 0.0, 1.0], (3, 1))
    stuck = solved(problem, (0, 0), straight)
    assert (stuck.code, stuck.starts, stuck.source) == (FAILED, 1, GIVEN)
    found = solved(problem, (0, 9), straight)
    assert (found.code, found.starts, found.source) == (SOLVED, 2, ARC)


def hard() -> Problem:
    """A pose of three fixed segments, which the first starts miss."""
    robot = Robot.uniform(3, 1.0, 2.0)
    for seed in range(200):
        problem = Problem(robot, target_at(shape(seed, robot), 2, robot))
        found = solved(problem, (0, 60))
        if found.code == SOLVED and found.starts > 3:
            return problem
    raise AssertionError("all are easy")


def test_a_search_in_parts_is_the_same_search() -> None:
    """Starts have numbers, and depend on nothing else: also not on the starts before them."""
    problem = hard()
    whole = solved(problem, (0, 60))
    before, after = solved(problem, (0, 2)), solved(problem, (2, 60))
    assert before.code == FAILED
    np.testing.assert_array_equal(after.q, whole.q)
    assert (before.starts + after.starts, before.iterations + after.iterations) == (whole.starts, whole.iterations)


def test_the_seed_is_all_that_differs() -> None:
    problem = hard()
    one, same = solved(problem, (1, 60), seed=1), solved(problem, (1, 60), seed=1)
    np.testing.assert_array_equal(one.q, same.q)
    assert one[1:10] == same[1:10]
    others = {solved(problem, (1, 2), seed=seed).q.tobytes() for seed in range(10)}
    assert len(others) == 10


@pytest.mark.parametrize("given_each", [0, 1, 2])
def test_what_is_proved_impossible_is_tried_once(given_each: int) -> None:
    initial = [shape(seed) for seed in range(given_each)]
    far = solved(Problem(ROBOT, Target((0.0, 0.0, 99.0))), (0, 40), initial)
    assert (far.code, far.starts) == (OUT_OF_REACH, given_each + 1)
    within = solved(Problem(ROBOT, Target((0.6, 0.0, 2.0)), SCENE), (0, 40), initial)
    assert (within.code, within.starts) == (TARGET_BLOCKED, given_each + 1)


def test_the_budget_of_time_is_kept() -> None:
    robot = Robot.uniform(30, (0.5, 1.0), 0.5)
    # Two places farther apart than the two segments between them: not proved to be impossible.
    problem = Problem(robot, [Target((2, 0, 12), segment=16), Target((-2, 0, 12), segment=18)])
    solved(problem, (0, 1))
    began = time.process_time()  # other work on the machine does not count
    none = solved(problem, (0, 10**6), seconds=0.0)
    assert (none.code, none.starts) == (LATE, 1)
    assert none.iterations <= 3
    some = solved(problem, (0, 10**6), seconds=0.05)
    assert time.process_time() - began < 1.0
    assert some.code == LATE
    assert some.starts > 1
    assert some.seconds >= 0.05
