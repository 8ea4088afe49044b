"""What planners are asked: goals, which may become more and more, and the deadline."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.motion.configurations import distances
from sinuous.motion.planning.query import APART, MOST_GOALS, Deadline, FixedGoal, TargetGoals
from tests.kernels.certificate.motions import shape
from tests.kernels.planning.test_query import ROBOT, pair


def test_what_is_reached_is_drawn_to_the_target() -> None:
    scene, (_, goal) = pair(0)
    solver, rng = sn.Solver(ROBOT, scene), np.random.default_rng(0)
    first = solver.solve(sn.Target(ROBOT.tip(goal)[:3, 3]))
    goals = TargetGoals(solver, list(first.problem.targets), [first])
    np.testing.assert_array_equal(goals(goal[None]), [first.q])  # the root alone tells nothing new
    for _ in range(12):
        found = goals(np.stack([shape(ROBOT, rng) for _ in range(30)]))
    assert 5 < len(found) <= MOST_GOALS + 8
    assert all(solution.solved and solution.verify().ok for solution in goals.solutions)
    apart = [float(distances(ROBOT, np.stack([one, other]))[0]) for i, one in enumerate(found) for other in found[:i]]
    assert min(apart) > APART * ROBOT.mean_length


def test_a_configuration_is_the_only_goal() -> None:
    q = np.zeros((4, 3))
    np.testing.assert_array_equal(FixedGoal(q)(np.ones((9, 4, 3))), [q])


def test_what_is_compiled_meanwhile_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [10.0]
    monkeypatch.setattr("sinuous.motion.planning.query.work_time", lambda: now[0])
    deadline = Deadline(5.0)
    now[0] += 1.0
    assert (deadline.spent, deadline.left()) == (1.0, 4.0)
    with deadline.paused():
        now[0] += 30.0
    assert (deadline.spent, deadline.left()) == (1.0, 4.0)
    now[0] += 7.0
    deadline.set_spent(2.0)
    assert (deadline.spent, deadline.left()) == (2.0, 3.0)
