"""What verbs take: a position or a pose for a target, an obstacle for a scene, a segment by its name."""

from typing import Any

import numpy as np

import sinuous as sn
from tests.helpers import refused, refused_each, with_each

ROBOT = sn.Robot.uniform(3, (45, 70), max_bend=1.6, radius=4)
BALL = sn.Sphere((0, 100, 100), radius=10, name="ball")
PLACE = np.array([60.0, 0.0, 150.0])
TURNED = sn.pose(PLACE, direction=(1, 0, 1))


def test_a_pose_is_a_target() -> None:
    expected = sn.Target(PLACE, rotation=TURNED[:3, :3])
    for pose in (TURNED, TURNED.tolist(), tuple(map(tuple, TURNED.tolist()))):
        assert sn.Target(pose).equals(expected)
    assert sn.Target(TURNED, segment=2).equals(expected.changed(segment=2))
    refused(
        "position", lambda: sn.Target(TURNED, direction=(0, 0, 1)), "cannot be combined with a rotation or direction"
    )
    refused("position", lambda: sn.Target(TURNED, rotation=(1, 0, 0, 0)), "cannot be combined with")
    refused("position.matrix", lambda: sn.Target(2.0 * TURNED), "last row")
    refused_each("position", ([1, 2], [[1, 2, 3]] * 4, np.eye(3)), sn.Target, "3 finite numbers")


@with_each("place", [PLACE, PLACE.tolist(), tuple(PLACE), TURNED, TURNED.tolist()])
def test_a_place_is_a_target_wherever_one_is_asked_for(place: Any) -> None:
    target, solver = sn.Target(place), sn.Solver(ROBOT, seed=1)
    wanted = solver.solve(target)
    assert wanted.solved
    assert sn.solve(ROBOT, place, seed=1).q.tolist() == solver.solve(place).q.tolist() == wanted.q.tolist()
    assert solver.solve_many([place, target]).q.tolist() == [wanted.q.tolist()] * 2
    assert sn.track(ROBOT, [place]).solutions[0].problem.targets[0].equals(target)
    assert sn.plan(ROBOT, [[0, 0.1, 55]] * 3, place).solutions[0].problem.targets[0].equals(target)
    assert sn.Job(ROBOT, place).waypoints[0][0].equals(target)
    assert sn.Problem(ROBOT, place).targets[0].equals(target)
    assert solver.step(wanted, target=place, dt=0.1).status == "reached"
    assert sn.check(ROBOT, wanted.q, targets=place).ok


def test_what_is_no_place_is_refused() -> None:
    refused("target.position", lambda: sn.solve(ROBOT, (1.0, float("nan"), 3.0)), "finite numbers")
    guess: Any = "tip"
    refused(
        "target",
        lambda: sn.solve(ROBOT, guess),
        "a position of 3 numbers, a pose (4, 4), a Target, or a list of Targets",
    )
    near = np.array([[0, 0.1, 55.0]] * 3)
    assert sn.plan(ROBOT, near, near + 0.01).solutions == ()  # a configuration, though it has three rows


def test_one_obstacle_is_a_scene() -> None:
    listed = sn.solve(ROBOT, PLACE, [BALL])
    for scene in (BALL, sn.Scene(BALL)):
        assert sn.solve(ROBOT, PLACE, scene).clearance == listed.clearance
    assert sn.track(ROBOT, [PLACE], BALL).scene.name(0) == "ball"
    assert len(sn.Job(ROBOT, PLACE, BALL).scene) == 1
    assert sn.check(ROBOT, listed.q, BALL).ok


def test_answers_know_their_robot_and_their_tips() -> None:
    solution = sn.solve(ROBOT, PLACE)
    assert solution.robot is solution.problem.robot
    np.testing.assert_array_equal(solution.tip, ROBOT.tip(solution.q))
    motion = sn.track(ROBOT, [PLACE, np.add(PLACE, (5, 0, 0))], start=[[0, 0.1, 55]] * 3)
    np.testing.assert_array_equal(motion.tips, ROBOT.tip(motion.q))
    assert motion.duration == motion.times[-1] - motion.times[0]


NAMED = sn.Robot([sn.Segment((40, 60), 2, name=name) for name in ("shoulder", "elbow", "wrist")], radius=4)
ELBOW = sn.Target((20, 10, 90), segment="elbow")
Q = [[0.0, 0.1, 50.0]] * 3


def test_a_segment_may_be_named_wherever_one_is_asked_for() -> None:
    both = [ELBOW, sn.Target((40, 20, 130))]
    solution = sn.solve(NAMED, both, sn.Sphere((0, 80, 100), 10), clearance={"wrist": 5})
    assert solution.solved
    assert solution.problem.targets[0].segment == 2
    assert solution.demanded_clearance == (0.0, 0.0, 5.0)
    numbered = sn.solve(NAMED, [ELBOW.changed(segment=2), both[1]], sn.Sphere((0, 80, 100), 10), clearance=(0, 0, 5))
    np.testing.assert_array_equal(solution.q, numbered.q)
    assert sn.check(NAMED, solution.q, targets=both).ok
    np.testing.assert_array_equal(NAMED.jacobian(Q, "elbow"), NAMED.jacobian(Q, 2))
    solver = sn.Solver(NAMED)
    assert solver.solve_many([ELBOW, both]).solved.all()
    assert solver.step(Q, target=ELBOW, dt=0.01).proved
    assert sn.track(NAMED, [ELBOW]).solved
    assert sn.plan(NAMED, Q, ELBOW).solved
    carrying = NAMED.changed(payload=sn.Payload(0.1, segment="elbow"))
    assert carrying.payload[0].segment == 2
    job = sn.Job(NAMED, path=[ELBOW])
    assert job.waypoints[0][0].segment == 2
    assert [
        r.segments[2].max_bend for r in sn.studies.sweep(NAMED, {"segments[wrist].max_bend": [1, 1.5]}).values()
    ] == [1, 1.5]


def test_a_name_of_no_segment_is_refused_and_the_nearest_is_said() -> None:
    solver, wrong = sn.Solver(NAMED), ELBOW.changed(segment="elbw")
    words = "no segment is called 'elbw'; did you mean 'elbow'?"
    refused("target.segment", lambda: solver.solve(wrong), words)
    refused("targets[1].segment", lambda: solver.solve_many([ELBOW, wrong]), words)
    refused("segment", lambda: NAMED.jacobian(Q, "elbw"), words)
    refused("clearance", lambda: sn.solve(NAMED, ELBOW, clearance={"elbw": 1}), words)
    refused("clearance.wrist", lambda: sn.solve(NAMED, ELBOW, clearance={"wrist": -1}), "at least 0")
    refused("payload.segment", lambda: NAMED.changed(payload=sn.Payload(1, segment="elbw")), words)
    refused(
        "fields['segments[elbw].radius']", lambda: sn.studies.sweep(NAMED, {"segments[elbw].radius": [1]}), "or one of"
    )
