"""The answer prints, raises and writes itself down."""

import json

import numpy as np
import pytest

import sinuous as sn

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.05)
SCENE = sn.Scene([sn.Sphere((1.0, 0.0, 1.0), 0.3, name="lamp")])


def test_a_solved_answer_prints_what_was_reached() -> None:
    solution = sn.solve(ROBOT, sn.Target((0, 1, 2), direction=(0, 1, 1)), SCENE)
    assert solution.raise_for_status() is solution
    assert solution.worst is None
    text = str(solution)
    for word in ("solved", "position", "angle", "clearance", "iterations"):
        assert word in text


def test_an_unsolved_answer_raises_and_says_why() -> None:
    solution = sn.solve(ROBOT, sn.Target((0, 0, 9)))
    with pytest.raises(sn.NotSolvedError, match="out_of_reach") as caught:
        solution.raise_for_status()
    assert caught.value.solution is solution
    assert str(caught.value).startswith("out_of_reach (proved: ")
    assert str(solution.reason) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert solution.worst is not None
    assert solution.worst.constraint == "position"
    assert solution.worst.amount == pytest.approx(9 - 3.6, rel=1e-3)


@pytest.mark.parametrize("target", [sn.Target((0, 1, 2)), sn.Target((0, 0, 9)), sn.Target((1.0, 0.0, 1.0))])
def test_the_result_is_strict_json(target: sn.Target) -> None:
    solution = sn.solve(ROBOT, target, SCENE)
    written = json.loads(json.dumps(solution.to_dict(), allow_nan=False))
    assert written["status"] == str(solution.status)
    np.testing.assert_array_equal(written["q"], solution.q)
    assert (written["worst"] is None) == solution.solved


def test_actuators_are_in_the_result_and_printed() -> None:
    assert sn.solve(ROBOT, sn.Target((0, 1, 2))).to_dict()["actuators"] is None
    robot = sn.Robot.uniform(2, (0.8, 1.2), 2.0, tendons=sn.Tendons(2, 0.1), chambers=sn.Chambers(1, 0.1))
    solution = sn.solve(robot, sn.Target((0, 0.5, 1.7)))
    written = json.loads(json.dumps(solution.to_dict(), allow_nan=False))["actuators"]
    assert list(written) == ["s1.t1", "s1.t2", "s1.c1", "s2.t1", "s2.t2", "s2.c1"]
    np.testing.assert_array_equal(list(written.values()), robot.to_actuators(solution.q))
    assert f"actuators      s1.t1={written['s1.t1']:.4g}  s1.t2=" in str(solution)


def test_an_answer_speaks_of_the_scene_that_it_was_found_in() -> None:
    scene = sn.Scene([sn.PointCloud([[9.0, 9.0, 9.0]], 0.1, name="camera")])
    solver = sn.Solver(ROBOT, scene)
    free = solver.solve(sn.Target((0, 1, 2)))
    scene.update([[0.0, 1.0, 2.0]], 0.3)
    blocked = solver.solve(sn.Target((0, 1, 2)))
    scene.update([[9.0, 9.0, 9.0]], 0.1)
    assert free.solved
    assert free.verify().ok
    assert blocked.status is sn.Status.TARGET_BLOCKED
    assert not blocked.verify().ok
    assert blocked.reason is not None
    assert blocked.reason.available == pytest.approx(-0.3, abs=1e-2)
    assert blocked.worst is not None
    assert (blocked.worst.constraint, blocked.worst.obstacle) == ("clearance", "camera")
    assert free.problem.scene is not blocked.problem.scene
    assert solver.solve(sn.Target((0, 1, 2))).q.tobytes() == free.q.tobytes()
