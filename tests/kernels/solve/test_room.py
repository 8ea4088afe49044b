"""Answers in contact are led away from it, and stay answers."""

from typing import Any

import numpy as np

import sinuous as sn
from sinuous.checks import Floats
from sinuous.kernels import tables
from sinuous.kernels.solve.room import GRAZING, STEPS, take_room
from sinuous.measures.body import least_clearance
from sinuous.problem.problem import Problem
from sinuous.solution.verification import verify
from tests.helpers import kernel_problem
from tests.kernels.workspace import NEVER, make_states, make_work

ROBOT = sn.Robot.uniform(5, (45.0, 70.0), 2.4, radius=4.0)
SCENE = sn.Scene([sn.Sphere((60.0, 0.0, 110.0), 30.0), sn.Sphere((-70.0, 10.0, 130.0), 35.0)])
ROOM = 0.4


def touching(count: int) -> list[tuple[sn.Target, sn.Solution]]:
    """Targets, and answers to them in contact."""
    solver = sn.Solver(ROBOT, SCENE, max_starts=6, routes=False)
    solver._prepared._settings[tables.ROOM] = 0.0  # type: ignore[attr-defined]
    rng = np.random.default_rng(3)
    positions = rng.uniform([-140.0, -140.0, 60.0], [140.0, 140.0, 220.0], (600, 3))
    found = solver.solve_many(positions=positions, workers=1)
    near = np.flatnonzero(found.solved & (found.clearance < GRAZING * ROOM))[:count].tolist()
    assert len(near) == count
    return [(sn.Target(positions[i]), found[i]) for i in near]


def taken(target: sn.Target, before: sn.Solution, room: float, deadline: int = NEVER) -> tuple[Floats, int, Any]:
    problem = kernel_problem(ROBOT, target, SCENE)
    best, known = before.q.copy(), (0.125, 0.25, before.clearance, 0.75, 0.5)  # no values that are found again
    used, after = take_room(problem, make_states(problem), make_work(problem, deadline), room, known, best)
    return best, used, after


def test_answers_in_contact_get_room_and_stay_answers() -> None:
    better = 0
    for target, before in touching(8):
        best, used, (off, turn, clearance, _, _) = taken(target, before, ROOM)
        assert 0 < used <= STEPS
        found = verify(Problem(ROBOT, target, SCENE), best)
        assert found.ok
        if clearance > before.clearance:
            assert abs(found.position_error - off) < 1e-9
            assert turn == 0.0
            assert clearance <= least_clearance(ROBOT, SCENE, best[None])[0] + 1e-9
            better += clearance > 5.0 * before.clearance
        else:
            np.testing.assert_array_equal(best, before.q)
    assert better >= 6


def test_where_there_is_room_or_no_time_nothing_changes() -> None:
    for target, before in touching(2):
        known = 0.125, 0.25, before.clearance, 0.75, 0.5
        for room, deadline in ((0.0, NEVER), (before.clearance / GRAZING, NEVER), (ROOM, 0)):
            best, used, after = taken(target, before, room, deadline)
            assert (used, after) == (0, known)
            np.testing.assert_array_equal(best, before.q)
