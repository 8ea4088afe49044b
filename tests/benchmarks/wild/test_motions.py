"""Motions of wild worlds: an honest motion is not accused, and one that leaves the proved way is found out."""

import numpy as np
import pytest

from benchmarks.wild import motions
from benchmarks.wild.motions import Judged
from sinuous import Trajectory
from sinuous.checks import Floats
from sinuous.robot.robot import Robot
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
