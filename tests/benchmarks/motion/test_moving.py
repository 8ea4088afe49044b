"""The judges of motions and loops in time find what is wrong, and nothing where nothing is."""

import numpy as np
import pytest

import sinuous as sn
from benchmarks.motion.in_time import clouds, moving
from sinuous.motion.report import Report

ROBOT = sn.Robot.uniform(2, (0.8, 1.2), radius=0.05)
STRAIGHT = np.tile([0.0, 0.0, 1.0], (3, 2, 1))
BALL = sn.Moving(sn.Sphere((0, 0, 0), 0.3), [0, 1, 2], [(2, 0, 1), (0.5, 0, 1), (2, 0, 1)])


def test_a_plan_is_right() -> None:
    trial = moving.planned(2, {"rates": moving.RATES})
    assert trial.solved
    assert trial.wrong == ""


def test_what_is_wrong_is_found() -> None:
    motion = sn.Motion(ROBOT, STRAIGHT, [BALL])
    assert motion.solved
    assert moving.judged(motion) == ""
    late = motion.made(ROBOT, sn.Scene([nearer()]).snapshot(), motion.q, motion.times, motion.steps, told(motion))
    assert moving.judged(late) == "obstacle"
    boast = sn.Motion(ROBOT, STRAIGHT, [sn.Moving(sn.Sphere((0, 0, 0), 0.1), [0], [(0.5, 0, 1)])])
    wrong = motion.made(ROBOT, motion.scene, motion.q, motion.times, boast.steps, told(motion))
    assert moving.judged(wrong) == "clearance"


def nearer() -> sn.Moving:
    return sn.Moving(sn.Sphere((0, 0, 0), 0.3), [0, 1, 2], [(2, 0, 1), (0.3, 0, 1), (2, 0, 1)])


def told(motion: sn.Motion) -> Report:
    return Report(method=motion.method)


@pytest.mark.parametrize("how", [clouds.MOVED, clouds.SEEN])
def test_a_short_loop_is_right(monkeypatch: pytest.MonkeyPatch, how: str) -> None:
    monkeypatch.setattr(clouds, "TICKS", 5)
    monkeypatch.setattr(clouds, "POINTS", 2000)
    loop = clouds.drive(1, how)
    assert len(loop.seconds) == 5
    assert loop.contacts == 0
    assert loop.least > 0.0
