"""Goals of a plan: more and more configurations that meet the same targets, or the one that was given."""

import numpy as np

import sinuous as sn
from sinuous.motion.planning.goals import APART, MOST, FixedGoal, Goals, _apart
from tests.kernels.between.motions import shape
from tests.kernels.planning.test_query import ROBOT, pair


def test_what_is_reached_is_drawn_to_the_target() -> None:
    scene, (_, goal) = pair(0)
    solver, rng = sn.Solver(ROBOT, scene), np.random.default_rng(0)
    first = solver.solve(sn.Target(ROBOT.tip(goal)[:3, 3]))
    goals = Goals(solver, first)
    np.testing.assert_array_equal(goals(goal[None]), [first.q])  # the root alone tells nothing new
    for _ in range(12):
        found = goals(np.stack([shape(ROBOT, rng) for _ in range(30)]))
    assert 5 < len(found) <= MOST + 8
    assert all(solution.solved and solution.verify().ok for solution in goals.solutions)
    apart = [_apart(ROBOT, one, other) for i, one in enumerate(found) for other in found[:i]]
    assert min(apart) > APART * ROBOT.mean_length


def test_a_configuration_is_the_only_goal() -> None:
    q = np.zeros((4, 3))
    np.testing.assert_array_equal(FixedGoal(q)(np.ones((9, 4, 3))), [q])
