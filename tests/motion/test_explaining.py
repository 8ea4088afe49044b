"""A motion says why it ended so; every change that it names makes it a motion that is proved."""

import numpy as np
import pytest

import sinuous as sn

ROBOT = sn.Robot.uniform(2, length=(40, 60), max_bend=1.6, radius=4)
SIDES = np.array([[[0.0, -0.9, 50], [0, 0, 50]], [[0.0, 0.9, 50], [0, 0, 50]]])
BALL = sn.Sphere((0, 0, 85), radius=6, name="ball")


def test_a_motion_through_a_ball_names_the_ball_the_place_and_a_thinner_body() -> None:
    thick = sn.Sphere((0, 0, 85), radius=2, name="ball")
    motion = sn.Motion(ROBOT, SIDES, [thick, sn.Sphere((500, 0, 0), radius=1)])
    found = motion.explain(60.0)
    assert motion.status == sn.Status.BLOCKED == found.status
    (held,) = found.binding
    assert (held.constraint, held.obstacle, held.limit) == ("clearance", "ball", 0.0)
    assert held.place is not None
    assert held.value == pytest.approx(-motion.worst.amount)  # type: ignore[union-attr]
    without = next(remedy for remedy in found.remedies if remedy.change == "obstacle ball")
    assert "deep in it, at (" in str(without)
    assert sn.Motion(ROBOT, SIDES, [sn.Sphere((500, 0, 0), radius=1)]).solved
    assert "would help without obstacle ball" in str(found)


def test_the_thickest_body_that_is_told_passes() -> None:
    beside = sn.Sphere((12, 0, 85), radius=9, name="beside")
    motion = sn.Motion(ROBOT, SIDES, [beside])
    radius = next(remedy for remedy in motion.explain(60.0).remedies if remedy.change == "radius")
    thin = sn.Robot.uniform(2, length=(40, 60), max_bend=1.6, radius=radius.after)
    assert 0.0 < radius.after < 4.0
    assert sn.Motion(thin, SIDES, [beside]).solved
    thicker = sn.Robot.uniform(2, length=(40, 60), max_bend=1.6, radius=radius.after + 0.1)
    assert not sn.Motion(thicker, SIDES, [beside]).solved


def test_a_path_says_what_its_first_waypoint_says() -> None:
    motion = sn.track(ROBOT, [(0, 0, 100), (0, 0, 400)])
    found = motion.explain(60.0)
    assert found.status == motion.status == sn.Status.OUT_OF_REACH
    assert "waypoint 2" in found.sentence
    assert found.remedies == motion.solutions[1].explain(60.0).remedies
    assert found.remedies


def test_verification_has_the_places_where_it_is_nearest() -> None:
    motion = sn.Motion(ROBOT, SIDES, [BALL])
    (step,) = motion.verify()
    assert not step.ok
    assert step.place is not None
    middle = np.array(step.place.position)
    assert np.linalg.norm(middle - BALL.center) == pytest.approx(step.clearance + BALL.radius + 4.0, abs=1e-6)
    assert step.place.segment == step.segment
    assert "in ball at (" in repr(step)
    one = sn.check(ROBOT, SIDES[0], [BALL])
    assert one.place is not None
    assert np.linalg.norm(np.array(one.place.position) - BALL.center) == pytest.approx(one.clearance + 10.0, abs=1e-6)
    many = sn.check(ROBOT, SIDES, [BALL])
    assert many.place[0] == one.place


def test_where_no_change_was_tried_none_is_said_to_be_in_vain() -> None:
    wall = sn.Box((0, 0, 124), size=(400, 1, 200))
    across = sn.plan(ROBOT, SIDES[0] * (1, 1.5, 1), SIDES[1] * (1, 1.5, 1), [wall], time=0.01)
    assert across.status == sn.Status.TIME_LIMIT
    said = str(across.explain())
    assert "No change was tried" in said
    assert "Nothing" not in said
