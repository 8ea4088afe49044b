"""Motions of wild worlds: an honest motion is not accused, and one that leaves the proved way is found out."""

import numpy as np
import pytest

from benchmarks.judges.bodies import thicker
from benchmarks.wild import motions
from benchmarks.wild.motions import Judged
from sinuous import Trajectory
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot, Uncertainty
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene

ROBOT = Robot.uniform(2, 1.0, 2.0, radius=0.1)
STRAIGHT = np.array([[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]])


def test_what_judges_refute_is_named() -> None:
    assert motions._refuted(ROBOT, Scene([Sphere((1.0, 0.0, 1.0), 0.5)]), STRAIGHT) == ""
    assert motions._refuted(ROBOT, Scene([Sphere((0.5, 0.0, 1.0), 0.5)]), STRAIGHT) == "overlap"
    assert motions._refuted(ROBOT, Scene(), STRAIGHT * [1.0, 1.0, 2.0]) == "limits"


def test_a_trajectory_that_leaves_its_limits_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    number = next(number for number in range(20) if motions.timed(0, number) == Judged(True, ""))
    at = Trajectory.at

    def longer(self: Trajectory, t: Floats) -> Floats:
        return at(self, t) * [1.0, 1.0, 1.0 + 1e-6]

    monkeypatch.setattr(Trajectory, "at", longer)
    assert motions.timed(0, number).false in ("limits", "rates")


@pytest.mark.parametrize("number", [68, 424])
def test_ways_are_timed_where_the_pass_of_toppra_gives_up(number: int) -> None:
    assert motions.timed(7, number).false == ""


def test_a_tree_that_stands_at_its_goal_and_touches_does_not_grow() -> None:
    """It grew to where no number is, and a solve from there was refused."""
    assert motions.live(8, 77).false == ""


def test_a_motion_in_a_live_scene_is_judged_in_the_scene_that_it_names(monkeypatch: pytest.MonkeyPatch) -> None:
    found = [motions.live(0, number) for number in range(4)]
    assert all(each.false == "" for each in found)
    looked: list[Scene] = []

    def judge(_robot: Robot, scene: Scene, _q: Floats) -> str:
        looked.append(scene)
        return "overlap"

    monkeypatch.setattr(motions, "_refuted", judge)
    number = next(i for i, each in enumerate(found) if each.proved)
    assert motions.live(0, number).false == "overlap"
    assert looked[0].obstacles[0].name == "ball"


def test_what_robots_demand_is_judged() -> None:
    ball = Scene([Sphere((0.65, 0.0, 1.0), 0.5)])
    assert motions._refuted(ROBOT, ball, STRAIGHT) == ""
    assert motions._refuted(ROBOT.changed(clearance=0.1), ball, STRAIGHT) == "overlap"
    assert motions._refuted(ROBOT.changed(uncertainty=Uncertainty(0.1)), ball, STRAIGHT) == "overlap"
    folded = Robot.uniform(2, (0.5, 1.0), 4.0, radius=0.1)
    ring = np.array([[[3.0, 0.0, 1.0], [3.0, 0.0, 1.0]]])
    assert motions._refuted(folded, Scene(), ring[:, :1].repeat(2, 1) * [0.9, 1.0, 1.0]) == ""
    assert (
        motions._refuted(folded.changed(self_clearance=0.5), Scene(), ring * [0.9, 1.0, 1.0]) == "overlap with itself"
    )


@pytest.mark.parametrize("kind", ["ticks", "planned", "raced"])
def test_a_proof_that_is_none_is_found_out(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    judge = getattr(motions, kind)
    found = [judge(0, number) for number in range(4)]
    assert all(each.false == "" for each in found)
    assert any(each.proved for each in found)
    for name in ("needed_body", "self_body"):
        monkeypatch.setattr(motions, name, lambda robot: thicker(robot, 5.0 * robot.mean_length))
    assert any(judge(0, number).false for number in range(4))


def test_ticks_that_are_too_fast_are_found_out() -> None:
    rates = np.array([1.0, 2.0])
    assert motions._too_fast(rates, motions.TICK * np.array([[0.6, 0.8, 2.0]])) == ""
    assert motions._too_fast(rates, motions.TICK * np.array([[0.7, 0.8, 2.0]])) == "rates"
    assert motions._too_fast(rates, motions.TICK * np.array([[0.6, 0.8, -2.1]])) == "rates"
