"""The answer prints, raises and writes itself down.

Explanations in words.
"""

import json
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import present, refused

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
    assert present(blocked.reason).available == pytest.approx(-0.3, abs=1e-2)
    assert blocked.worst is not None
    assert (blocked.worst.constraint, blocked.worst.obstacle) == ("clearance", "camera")
    assert free.problem.scene is not blocked.problem.scene
    assert solver.solve(sn.Target((0, 1, 2))).q.tobytes() == free.q.tobytes()


BARELY_BENT = sn.Robot.uniform(3, length=(0.8, 1.0), max_bend=0.5, radius=0.1)


def test_a_failure_is_explained() -> None:
    solution = sn.solve(BARELY_BENT, sn.Target((0, 0, 3.5)))
    explanation = solution.explain(time=60.0)
    assert str(explanation).splitlines() == [
        "out_of_reach: proved: no configuration within the limits gets there",
        "  because    the target is 0.4997 farther from the base than the robot is long "
        "(3.5 away, the robot at most 3 long)",
        "  best found 0.5 from the position",
        "  held by    greatest length of all segments: at its limit of 1",
        *str(explanation).splitlines()[4:],
    ]
    helped = str(explanation).splitlines()[4:]
    assert helped[0].startswith("  would help length of all segments: [0.8, 1] -> [0.8, 1.16")
    assert helped[1].startswith("             target position: [0, 0, 3.5] -> [")


def test_a_solution_says_what_is_nearest_to_its_limit() -> None:
    explanation = sn.solve(BARELY_BENT, sn.Target((0, 0, 2.94))).explain()
    assert (explanation.remedies, explanation.binding, explanation.complete) == ((), (), True)
    assert {each.key for each in explanation.nearest} == {"length[1]"}
    assert str(explanation).splitlines() == [
        "solved: all within tolerance and limits, whole body proved clear of obstacles and of itself",
        "  nearly at  greatest length of all segments: 0.98, at most 1 is allowed",
    ]


def test_of_a_result_from_a_file_no_change_is_tried_and_that_is_said() -> None:
    solution = sn.solve(BARELY_BENT, sn.Target((0, 0, 3.5)))
    loaded = sn.Solution.from_dict(solution.to_dict(), solution.problem).explain()
    assert (loaded.remedies, loaded.complete) == ((), False)
    told = str(loaded).splitlines()
    assert told[:4] == str(solution.explain(60.0)).splitlines()[:4]
    assert told[4:] == [
        "  No change was tried: a result that was read from a file does not say with which options it was found."
    ]


def test_a_limit_that_stops_is_named_whatever_happens() -> None:
    """Also where no force is left: straight up, a target behind pulls nowhere."""
    tendons = sn.Tendons(3, 0.1, displacement=(-0.02, 0.02))
    robot = sn.Robot.uniform(2, (0.9, 1.1), 3.0, tendons=tendons)
    for place in ((0, 0, -1), (0, 0, 0.5), (1, 1, 0), (0.3, 0, 1.0), (0, -1, -0.3)):
        solution = sn.solve(robot, sn.Target(place), max_starts=20)
        if solution.status is sn.Status.LIMIT_BOUND:
            assert any(each.key is not None for each in solution.binding)
            assert solution.sentence.startswith("not solved: limits stop the best found: ")


@pytest.mark.parametrize("time", [-1.0, float("nan"), "2", None])
def test_a_wrong_time_is_refused(time: Any) -> None:
    solution = sn.solve(BARELY_BENT, sn.Target((0, 0, 2.5)))
    refused("time", lambda: solution.explain(time=time))


def test_what_obstacles_have_no_part_in_is_said() -> None:
    robot = sn.Robot.uniform(3, length=1.0, max_bend=0.5, radius=0.1)
    target = sn.Target((0.78, 1.52, 2.04), direction=(-0.09, 0.61, 0.68))
    text = str(sn.solve(robot, target, sn.Sphere((0, 0, 2), 0.1, name="ball"), max_starts=30).explain(time=60.0))
    assert "The target is not reached even without obstacles." in text
    assert "fixed length of all segments: 1" in text
    assert "least length" not in text
