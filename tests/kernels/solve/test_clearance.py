"""Answers in contact are led away from it, and stay answers."""

from typing import Any

import numpy as np

import sinuous as sn
from sinuous.answer.verification import verify
from sinuous.kernels import tables
from sinuous.kernels.clock import DEADLINE, STRIDE, WORK
from sinuous.kernels.solve.clearance import CLEARANCE_STEPS, GRAZING, increase_clearance
from tests.helpers import Floats, kernel_problem
from tests.kernels.workspace import NEVER, make_workspace

ROBOT = sn.Robot.uniform(5, (45.0, 70.0), 2.4, radius=4.0)
SCENE = sn.Scene([sn.Sphere((60.0, 0.0, 110.0), 30.0), sn.Sphere((-70.0, 10.0, 130.0), 35.0)])
ROOM = 0.4


def touching(count: int) -> list[tuple[sn.Target, Floats, float]]:
    """Targets, answers to them in contact, and the clearances of these."""
    solver = sn.Solver(ROBOT, SCENE, max_starts=6, routes=False)
    solver._prepared._settings[tables.CLEARANCE_MARGIN] = 0.0
    rng = np.random.default_rng(3)
    positions = rng.uniform([-140.0, -140.0, 60.0], [140.0, 140.0, 220.0], (600, 3))
    found = solver.solve_many(positions=positions, workers=1)
    near = np.flatnonzero(found.solved & (found.clearance < GRAZING * ROOM))[:count].tolist()
    assert len(near) == count
    return [(sn.Target(positions[i]), found.q[i], float(found.clearance[i])) for i in near]


def taken(
    target: sn.Target, q: Floats, clearance: float, room: float, *, late: bool = False
) -> tuple[Floats, int, Any]:
    problem = kernel_problem(ROBOT, target, SCENE)
    best, (states, work) = q.copy(), make_workspace(problem)
    known = 0.125, 0.25, clearance, 0.75, 0.5  # no values that are found again
    work.clock[DEADLINE], work.clock[WORK] = (0, STRIDE) if late else (NEVER, 0)
    used, after = increase_clearance(problem, states, work, room, known, best)
    return best, used, after


def test_answers_in_contact_get_room_and_stay_answers() -> None:
    gained = []
    for target, q, before in touching(8):
        best, used, (off, turn, clearance, _, _) = taken(target, q, before, ROOM)
        assert 0 < used <= CLEARANCE_STEPS
        found = verify(sn.Problem(ROBOT, target, SCENE), best)
        assert found.ok
        gained.append(clearance / before)
        if gained[-1] == 1.0:
            np.testing.assert_array_equal(best, q)
        else:
            assert abs(found.position_error - off) < 1e-9
            assert turn == 0.0
            assert clearance <= found.clearance + 1e-9
    assert min(gained) >= 1.0
    assert np.median(gained) > 4.0


def test_where_there_is_room_or_no_time_nothing_changes() -> None:
    for target, q, before in touching(2):
        for room, late in ((0.0, False), (before / GRAZING, False), (ROOM, True)):
            best, used, after = taken(target, q, before, room, late=late)
            assert (used, after) == (0, (0.125, 0.25, before, 0.75, 0.5))
            np.testing.assert_array_equal(best, q)
