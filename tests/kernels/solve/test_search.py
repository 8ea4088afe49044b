"""The starts of one solve: their order, their numbers and their seed.

The nearest poses, against a sort of all, and how far configurations are apart, against NumPy.
"""

import numpy as np

import sinuous as sn
from sinuous.kernels.solve.recall import compare
from sinuous.kernels.solve.search import search
from sinuous.kernels.step.states import workspace_size
from sinuous.kernels.tables import ARC, FAILED, GIVEN, SOLVED, Outcome
from sinuous.model.robot import Robot, robot_group
from sinuous.problem.problem import Problem, settings_group
from sinuous.problem.target import Target
from tests.helpers import Floats
from tests.methods.laws import tip_targets

LONG = 30.0
NOTHING = np.empty((0, 3, 3))


def solved(problem: Problem, own: tuple[int, int], initial: Floats = NOTHING, seed: int = 0) -> Outcome:
    robot, targets = problem.robot, problem.rows.copy()
    workspace = np.empty(workspace_size(len(robot), len(robot.actuation), len(problem.scene), len(targets)))
    best, settings = np.full((len(robot), 3), np.nan), settings_group(robot, problem.tolerance)
    group, budget = problem.scene.group.copy(), (*own, seed, LONG)
    return Outcome(best, *search(robot_group(robot), group, settings, targets, initial, budget, workspace, best))


def test_own_starts_follow_what_is_given_in_vain() -> None:
    """Straight, and the target straight ahead, but too near: no side to bend to, while the arc leads to it."""
    robot = Robot.uniform(3, 1.0, 3.0)
    problem = Problem(robot, Target((0.0, 0.0, 2.0)))
    straight = np.tile([0.0, 0.0, 1.0], (1, 3, 1))
    stuck = solved(problem, (0, 0), straight)
    assert (stuck.code, stuck.starts, stuck.source) == (FAILED, 1, GIVEN)
    found = solved(problem, (0, 9), straight)
    assert (found.code, found.starts, found.source) == (SOLVED, 2, ARC)


def hard() -> Problem:
    """A pose of three fixed segments, which the first starts miss."""
    robot = Robot.uniform(3, 1.0, 3.0)
    for seed in range(200):
        problem = Problem(robot, tip_targets(robot, 1, 3.0, seed, "rotation"))
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


ROBOT = sn.Robot.uniform(3, (0.5, 1.5), max_bend=2.5)
RNG = np.random.default_rng(0)
SHAPES = np.concatenate([RNG.uniform(-2, 2, (40, 3, 2)), RNG.uniform(0.5, 1.5, (40, 3, 1))], axis=2)


def test_configurations_are_as_far_apart_as_their_numbers() -> None:
    scales, found = np.array([1.0, 2.0, 0.5]), np.empty((8, 5))
    others = SHAPES.reshape(8, 5, 3, 3)
    compare(SHAPES[:8], others, scales, found)
    expected = np.abs((SHAPES[:8, None] - others) / scales).max(axis=(2, 3))
    np.testing.assert_allclose(found, expected, rtol=1e-14)
