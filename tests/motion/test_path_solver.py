"""Whole paths: where a path begins, the shapes along it, and slides to other shapes while the tip stays."""

from itertools import pairwise

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.motion.knots import Knot, TipLine
from sinuous.motion.strands import slide
from sinuous.motion.tip_steps import TipSteps
from tests.motion.test_departure import ACROSS, PLATE, off_line
from tests.motion.test_departure import ROBOT as BROAD

ROBOT = sn.Robot.uniform(4, (80, 120), max_bend=2.0, radius=8.0)
EDGE = [(43, -49, z) for z in (34, 42, 49, 57, 65, 73, 80, 88)]
OTHER = [(47, -40, 92), *((x, y, 92) for x, y in zip((55, 63, 70, 78, 86, 94, 101), range(-38, -31), strict=True))]
CORNER = [sn.Target(p, direction=(0.68, -0.27, 0.68)) for p in EDGE]
CORNER += [sn.Target(p, direction=(0.21, -0.69, 0.69)) for p in OTHER]
"""Along two edges of a corner: from the shape that is found first, the last place is reached in another one only."""


def turned(motion: sn.Motion) -> float:
    """Largest angle of the tip from where it is asked to point on lines between waypoints, at many times."""
    worst = 0.0
    knots = [knot for knot in motion.waypoint_knots if knot is not None]
    for i, (a, b) in enumerate(pairwise(knots)):
        line = TipLine(*(motion.solutions[k].problem.targets[0] for k in (i, i + 1)))
        poses = motion.robot.tip(motion.at(np.linspace(motion.times[a], motion.times[b], 300)))
        asked = line.direction(line.shares_of(poses))
        worst = max(worst, float(np.arccos(np.clip((poses[:, :3, 2] * asked).sum(axis=1), -1.0, 1.0)).max()))
    return worst


def test_other_shapes_at_the_start_are_tried_before_a_path_is_left() -> None:
    left, whole = (sn.track(ROBOT, CORNER, time=0.5, reconfigure=way) for way in ("allow", "refuse"))
    assert left.left_steps
    assert whole.solved
    assert whole.verify().ok
    assert len(whole.solutions) == len(CORNER)


def test_the_robot_changes_its_shape_while_the_tip_stays() -> None:
    start = sn.track(ROBOT, CORNER, reconfigure="allow").q[0]
    motion = sn.track(ROBOT, CORNER, start=start)
    assert motion.solved
    assert motion.verify().ok
    assert motion.reconfigured
    assert motion.left_steps == ()
    np.testing.assert_array_equal(motion.q[0], start)
    assert motion.waypoint_knots[0] == 0
    assert len(motion.solutions) == len(CORNER)
    for solution, target, knot in zip(motion.solutions, CORNER, motion.waypoint_knots, strict=True):
        assert knot is not None
        np.testing.assert_array_equal(motion.q[knot], solution.q)
        assert solution.problem.targets == (target,)
    off = max(float(off_line(motion, i, i + 1).max()) for i in range(len(CORNER) - 1))
    assert off <= 10 * 1e-4 * ROBOT.mean_length
    assert turned(motion) <= 1e-2
    again = sn.track(ROBOT, CORNER, start=start)
    np.testing.assert_array_equal(again.q, motion.q)
    assert sn.track(ROBOT, CORNER, start=start, shortest="configuration").solved


def test_directions_are_kept_between_waypoints() -> None:
    """The place was within the deviation, and the tip turned away from the line by several times what is allowed."""
    path = [sn.Target((60 + 30 * t, -40.0, 250.0), direction=(0.5 - t, 0.4, 1.0)) for t in (0.0, 1.0)]
    motion = sn.track(ROBOT, path, deviation=5.0)
    assert motion.solved
    assert turned(motion) <= 1e-2
    assert motion.left_steps == ()


def test_a_line_that_cannot_be_reached_is_given_up_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[int] = []
    meet = TipSteps.meet

    def counted(self: TipSteps, targets: object, begin: object) -> sn.Solution | None:
        made.append(1)
        return meet(self, targets, begin)  # type: ignore[arg-type]

    monkeypatch.setattr(TipSteps, "meet", counted)
    motion = sn.track(BROAD, ACROSS, [PLATE])
    assert motion.status is sn.Status.LEFT_PATH
    assert len(made) < 200


def test_a_slide_keeps_the_targets() -> None:
    place, direction = np.array([60.0, -40.0, 250.0]), np.array([0.0, 0.6, 0.8])
    targets = (sn.Target(place, direction=direction),)
    solver = sn.Solver(ROBOT)
    steps = TipSteps(solver, 0.4)
    begin, end = (Knot(each.q, None, targets, each) for each in solver.solve_all(list(targets), count=2))
    knots = slide(steps, begin, end, targets)
    assert knots is not None
    np.testing.assert_array_equal(knots[-1].q, end.q)
    tips = ROBOT.tip(_dense([begin.q, *(knot.q for knot in knots)]))
    assert np.linalg.norm(tips[:, :3, 3] - place, axis=1).max() <= 0.4
    assert (tips[:, :3, 2] @ direction).min() >= np.cos(1e-2)


def _dense(knots: list[Floats]) -> Floats:
    return np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(knots)])
