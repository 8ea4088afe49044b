"""Moves as tasks: what planning them says."""

import numpy as np

import sinuous as sn
from sinuous.model.segment import straight
from tests.helpers import refused

ROBOT = sn.Robot.uniform(3, length=(45, 70), max_bend=1.5, radius=4, name="three")
BALL = sn.Sphere((0, 60, 120), radius=25, name="ball")
NEAR, INSIDE = sn.Target((0, 10, 165)), sn.Target((0, 60, 120))


def test_a_row_is_what_planning_says() -> None:
    found = sn.studies.assess(ROBOT, {"move": sn.studies.Move(NEAR), "inside": sn.studies.Move([INSIDE])}, [BALL])
    rows = {row.task: row for row in found.rows}
    motion = sn.plan(ROBOT, straight(ROBOT.segments), [NEAR], [BALL])
    done = rows["move"].done
    assert (rows["move"].kind, done.status, done.share) == ("plan", "solved", 1.0)
    assert (done.clearance, done.duration) == (motion.clearance, 1.0)
    assert (rows["inside"].done.status, rows["inside"].done.share) == ("target_blocked", 0.0)
    assert rows["inside"].done.binds == "ball"
    assert rows["inside"].done.duration is None


def test_a_start_where_the_robot_cannot_be_is_told() -> None:
    start = np.tile([0.0, 0.0, 80.0], (3, 1))
    (row,) = sn.studies.assess(ROBOT, [sn.studies.Move(NEAR, start)], [BALL]).rows
    assert (row.done.status, row.done.binds) == ("start_blocked", "length")


def test_what_is_no_move_is_refused() -> None:
    refused("goal", lambda: sn.studies.Move(3))  # type: ignore[arg-type]
    refused("start", lambda: sn.studies.Move(NEAR, [[1.0]]))
    refused("start", lambda: sn.studies.Move(NEAR, [[0.0, 0.0, 50.0]]).check(ROBOT))
