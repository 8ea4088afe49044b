"""What one guesses works, or is answered by what it is called."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.problem.suspicions import suspicions
from tests.cases import with_each
from tests.helpers import refused, refused_each

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


def test_a_scene_says_how_it_grows() -> None:
    scene: Any = sn.Scene(BALL)
    for name in ("add", "append", "remove"):
        with pytest.raises(AttributeError, match=r"sn\.Scene\(\[scene, obstacle\]\) is a new scene"):
            getattr(scene, name)(BALL)
    with pytest.raises(AttributeError, match="no attribute 'obstacle'"):
        _ = scene.obstacle


def test_answers_know_their_robot_and_their_tips() -> None:
    solution = sn.solve(ROBOT, PLACE)
    assert solution.robot is solution.problem.robot
    np.testing.assert_array_equal(solution.tip, ROBOT.tip(solution.q))
    motion = sn.track(ROBOT, [PLACE, np.add(PLACE, (5, 0, 0))], start=[[0, 0.1, 55]] * 3)
    np.testing.assert_array_equal(motion.tips, ROBOT.tip(motion.q))
    assert motion.duration == motion.times[-1] - motion.times[0]


MOVING = sn.Moving(BALL, [0, 1], [(0, 0, 0), (0, 3, 0)])


@pytest.mark.parametrize("scene", [None, BALL, MOVING], ids=["nothing", "ball", "moving"])
def test_motions_are_saved_and_loaded(scene: Any, tmp_path: Path) -> None:
    q = sn.solve(ROBOT, PLACE).q
    near = np.add(q, (0.01, 0.02, 0.3))
    motions = [
        sn.track(ROBOT, [PLACE, np.add(PLACE, (0, 9, 0))], scene, tolerance=sn.Tolerance(0.01)),
        sn.Motion(ROBOT, [q, near], scene),
        sn.plan(ROBOT, q, np.add(PLACE, (0, 9, 0)), scene, duration=2),
        sn.plan(ROBOT, q, near, scene, duration=2),
        sn.track(ROBOT, [PLACE, (0, 0, 900)], scene),
        sn.track(ROBOT, [PLACE, PLACE], sn.Sphere((0, 0, 50), radius=20), start=q),
    ]
    assert {str(motion.status) for motion in motions} == {"solved", "out_of_reach", "start_blocked"}
    for i, motion in enumerate(motions):
        for name in ("motion.yaml", "motion.json"):
            motion.save(tmp_path / name)
            again = sn.load(tmp_path / name, sn.Motion)
            assert again.equals(motion), (i, name)
            assert again.to_dict() == motion.to_dict()


def test_files_of_motions_are_checked(tmp_path: Path) -> None:
    sn.Motion(ROBOT, [[[0, 0.1, 55]] * 3, [[0, 0.2, 55]] * 3]).save(tmp_path / "motion.json")
    text = (tmp_path / "motion.json").read_text(encoding="utf-8")
    for old, new, key in (
        ('"steps": [', '"steps": [[1.0], ', "motion.steps"),
        ('"knots": [', '"knots": [[1.0], ', "motion.knots"),
        ('"remaining": 0', '"remaining": -1', "motion.remaining"),
    ):
        assert old in text
        (tmp_path / "wrong.json").write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(sn.InputError, match=r"wrong\.json: motion\.\w+: expected") as caught:
            sn.load(tmp_path / "wrong.json")
        assert caught.value.key == key
    with pytest.raises(sn.InputError, match="file: expected a Robot"):
        sn.load(tmp_path / "motion.json", sn.Robot)


def test_a_picture_goes_into_a_file(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib").use("agg")
    for name in ("arm.png", "arm.svg"):
        axes = sn.plot(ROBOT, path=tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000
        assert hasattr(axes, "get_proj")
    refused("path", lambda: sn.plot(ROBOT, path=tmp_path / "arm.txt"), "png")
    refused("path", lambda: sn.plot(ROBOT, path=tmp_path / "nowhere" / "arm.png"), "can be written")


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
    ] == [
        1,
        1.5,
    ]


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


def test_numbers_that_are_no_position_are_refused_as_a_whole() -> None:
    refused("target", lambda: sn.solve(NAMED, (1, 2)), "a position of 3 numbers, a pose (4, 4), a Target")
    refused("target", lambda: sn.solve(NAMED, (1, 2, 3, 4)), "not 3 numbers; ")
    place: Any = (0, 0, 150)
    refused("targets", lambda: sn.track(NAMED, place), "a list of targets")
    wrong: Any = "room.yaml"
    refused("scene", lambda: sn.solve(NAMED, place, wrong), "a list of obstacles", "sinuous.load reads files")


def test_attributes_that_one_guesses_say_where_that_is() -> None:
    solution = sn.solve(NAMED, (0, 0, 150))
    motion = sn.Motion(NAMED, [solution.q, solution.q])
    for thing, name, words in (
        (NAMED, "fk", "robot.tip"),
        (NAMED, "solve", "sn.solve"),
        (solution, "success", "solution.solved"),
        (solution, "to_csv", "solution.actuators"),
        (motion, "plot", "sn.plot"),
    ):
        with pytest.raises(AttributeError, match=words):
            getattr(thing, name)
        assert not hasattr(thing, "nothing")


def test_a_payload_without_gravity_is_noted() -> None:
    (note,) = suspicions(NAMED.changed(payload=sn.Payload(0.1)), sn.Scene().snapshot())
    assert "gravity" in note
