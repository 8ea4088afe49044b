"""The room that a robot on its way prefers."""

import numpy as np

import sinuous as sn
from sinuous.motion.track import HALF, Room
from sinuous.problem.preferences import Preferences

ROBOT = sn.Robot.uniform(5, (0.9, 1.1), 2.0, radius=0.02)
WALL = sn.Sphere((1.2, 0.0, 2.5), 0.9)


def test_half_of_the_room_is_enough() -> None:
    asked, room = Preferences(clearance=0.1), Room(clearance=0.1)
    assert asked.satisfied(0.1)
    assert not asked.satisfied(0.099)
    assert room.satisfied(0.1 * HALF)
    assert not room.satisfied(0.099 * HALF)
    assert not Preferences(bends=1.0).satisfied(1.0)


def test_a_robot_that_goes_on_keeps_its_room() -> None:
    """It is led past a sphere, near which a solve from afar would lean on it."""
    prefer = Preferences(clearance=0.1)
    solver = sn.Solver(ROBOT, [WALL], prefer=prefer)
    path = [sn.Target((x, 0.1, 4.4)) for x in np.linspace(0.3, 1.2, 10)]
    last = solver.solve(path[0])
    for target in path:
        last = solver.solve(target, last)
        assert last.solved
        assert last.clearance is not None
        assert last.clearance > 0.09
