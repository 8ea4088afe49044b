"""A start followed briefly ends in a solution, or touches nothing that it should not have."""

import numpy as np

import sinuous as sn
from sinuous.checks import Floats
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.clock import DEADLINE, LOOKS, STRIDE
from sinuous.kernels.solve.approach import BRIEF, approach
from sinuous.kernels.step.newton import MISSED
from sinuous.kernels.step.states import pick
from sinuous.problem.problem import Problem
from sinuous.solution.verification import verify
from tests.helpers import kernel_problem
from tests.kernels.workspace import NEVER, make_states, make_work

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.05)
Q = np.array([(0.3, 0.2, 1.0), (-0.2, 0.4, 0.9), (0.1, -0.3, 1.1)])
TARGET = sn.Target(ROBOT.tip(Q)[:3, 3])


def followed(
    start: Floats, scene: sn.Scene, target: sn.Target = TARGET, *, late: bool = False
) -> tuple[Floats, int, int, float]:
    problem = kernel_problem(ROBOT, target, scene)
    states, work = make_states(problem), make_work(problem)
    work.clock[DEADLINE], work.clock[LOOKS] = (0, STRIDE) if late else (NEVER, 0)
    states.q[0] = start
    at, verdict, used, clearance, _ = approach(problem, states, 0, work, 0.0)
    return pick(states, at).q.copy(), verdict, used, clearance


def test_from_nearby_it_ends_in_a_proved_solution_in_a_few_steps() -> None:
    scene = sn.Scene([sn.Sphere((1.5, 1.5, 1.0), 0.3)])
    q, verdict, used, clearance = followed(Q + 0.02, scene)
    assert (verdict, used) == (CLEAR, 2)
    found = verify(Problem(ROBOT, TARGET, scene), q)
    assert found.ok
    assert 0.9 * found.clearance - 1e-9 <= clearance <= found.clearance + 1e-9


def test_of_what_is_far_away_or_in_the_way_or_late_it_says_that_it_missed() -> None:
    free = sn.Scene([sn.Sphere((1.5, 1.5, 1.0), 0.3)])
    blocked = sn.Scene([sn.Sphere(ROBOT.tip(Q)[:3, 3], 0.2)])
    assert followed(Q, free, sn.Target((0.0, 0.0, 9.0)))[1:3] == (MISSED, BRIEF)
    assert followed(Q, blocked)[1:3] == (MISSED, BRIEF)
    assert followed(Q + 0.02, free, late=True)[1:3] == (MISSED, 0)
