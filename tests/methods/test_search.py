"""The search of every method but our own, with a method that does as it is told."""

import numpy as np
import pytest

from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.problem import Problem as Inner
from sinuous.kernels.tables import (
    FAILED,
    LATE,
    OUT_OF_REACH,
    RANDOM,
    SOLVED,
    Budget,
    Outcome,
    answer_size,
)
from sinuous.methods import search as method_search
from sinuous.methods.method import as_outcomes
from sinuous.methods.search import Answer, Check, check_size, offer
from sinuous.model.robot import Robot, robot_group
from sinuous.problem.problem import Problem, settings_group
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats

ROBOT = Robot.uniform(2, (0.8, 1.2), 2.0, radius=0.1)
RIGHT = np.array([[0.5, 0.2, 1.0]] * 2)
WRONG = np.array([[0.1, 0.0, 1.0]] * 2)
TARGET = Target(ROBOT.tip(RIGHT)[:3, 3])
ROOM = 50
NEVER = 1000


@kernel
def follow(
    problem: Inner, check: Check, scratch: Array, options: Array, start: method_search.Start, answer: Answer
) -> tuple[int, bool]:
    """Offer what is right from one start, and what is wrong from all others, and write down every start in `scratch`.

    `options`: the number of that start, the first that is not there, iterations, and both configurations.
    """
    row = 1 + 3 * int(scratch[0])
    scratch[0] += 1.0
    if start.index >= options[1]:
        return method_search.NO_START, False
    scratch[row], scratch[row + 1], scratch[row + 2] = start.index, method_search.own_number(start), start.seed
    first = 3 if start.index == options[0] else 9
    return int(options[2]), offer(problem, check, shaped(options[first : first + 6], (2, 3)), RANDOM, answer)


search = method_search.search_by(follow)


def run(
    targets: list[Target], options: tuple[int, int, int], given: int, budget: Budget, scene: Scene | None = None
) -> tuple[list[Outcome], Floats]:
    """Give outcomes, and which starts were followed: place, own number, seed."""
    problems = [Problem(ROBOT, target, scene, Tolerance(1e-3, 1e-3)) for target in targets]
    settings = settings_group(ROBOT, problems[0].tolerance, options=[*options, *RIGHT.flat, *WRONG.flat])
    answers = np.empty((len(targets), answer_size(2)))
    rows = np.stack([problem.rows for problem in problems])
    snapshot = problems[0].scene
    size = check_size(2, len(snapshot))
    workspace = np.zeros(size + 1 + 3 * ROOM)
    initial = np.broadcast_to(WRONG, (len(targets), given, 2, 3)).copy()
    robot, obstacles = robot_group(ROBOT), snapshot.group.copy()
    search(robot, obstacles, settings, rows, initial, budget, workspace, answers)
    return as_outcomes(answers), workspace[size + 1 :].reshape(ROOM, 3)[: int(workspace[size])].copy()


def test_starts_are_followed_in_order_until_one_is_solved() -> None:
    (found,), seen = run([TARGET], (3, NEVER, 7), 2, (5, 20, 9, 10.0))
    np.testing.assert_array_equal(seen, [[0, -1, 9], [1, -1, 9], [2, 5, 9], [3, 6, 9]])
    assert (found.code, found.starts, found.iterations, found.source) == (SOLVED, 4, 28, RANDOM)
    np.testing.assert_array_equal(found.q, RIGHT)


def test_without_a_solution_all_starts_are_followed_once() -> None:
    (found,), seen = run([TARGET], (NEVER, NEVER, 3), 1, (0, 6, 0, 10.0))
    assert (found.code, found.starts, found.iterations) == (FAILED, 7, 21)
    np.testing.assert_array_equal(seen[:, 1], [-1, 0, 1, 2, 3, 4, 5])
    np.testing.assert_array_equal(found.q, WRONG)


@pytest.mark.parametrize("given", [0, 2])
def test_it_ends_where_the_method_has_no_more_starts(given: int) -> None:
    (found,), _ = run([TARGET], (NEVER, 4, 3), given, (0, 20, 0, 10.0))
    assert (found.code, found.starts, found.iterations) == (FAILED, 4, 12)


def test_a_method_without_any_start_leaves_the_straight_robot() -> None:
    (found,), _ = run([TARGET], (NEVER, 0, 3), 0, (0, 20, 0, 10.0))
    assert (found.code, found.starts, found.iterations) == (FAILED, 0, 0)
    np.testing.assert_array_equal(found.q, [[0.0, 0.0, 1.0]] * 2)


def test_when_time_is_over_the_start_under_way_was_the_last() -> None:
    (late,), _ = run([TARGET], (NEVER, NEVER, 1), 0, (0, 20, 0, 0.0))
    assert (late.code, late.starts) == (LATE, 1)
    (found,), _ = run([TARGET], (0, NEVER, 1), 0, (0, 20, 0, 0.0))
    assert (found.code, found.starts) == (SOLVED, 1)


def test_the_impossible_is_tried_from_what_was_given_and_once_more() -> None:
    far = Target((0.0, 0.0, 3.0))
    (found,), seen = run([far], (NEVER, NEVER, 1), 2, (0, 20, 0, 10.0))
    assert (found.code, found.starts) == (OUT_OF_REACH, 3)
    np.testing.assert_array_equal(seen[:, 1], [-1, -1, 0])


def test_every_problem_has_its_own_answer() -> None:
    scene = Scene([Sphere((5.0, 0.0, 0.0), 1.0)])
    targets = [TARGET, Target((0.0, 0.0, 3.0)), TARGET, Target((0.3, 0.0, 1.5))]
    together, _ = run(targets, (1, NEVER, 2), 1, (0, 3, 0, 10.0), scene)
    assert [found.code for found in together] == [SOLVED, OUT_OF_REACH, SOLVED, FAILED]
    for target, one in zip(targets, together, strict=True):
        (alone,), _ = run([target], (1, NEVER, 2), 1, (0, 3, 0, 10.0), scene)
        np.testing.assert_array_equal(alone.q, one.q)
        assert alone._replace(q=one.q, seconds=0.0) == one._replace(seconds=0.0)
