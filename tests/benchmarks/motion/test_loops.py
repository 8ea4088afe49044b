"""The judge of control loops finds what is wrong, and nothing where nothing is."""

import numpy as np
import pytest

import sinuous as sn
from benchmarks.motion import loops


def test_a_short_loop_is_right(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loops, "TICKS", 20)
    loop = loops.drive(1)
    assert len(loop.seconds) == 20
    assert loop.wrong == 0


def test_what_is_wrong_is_counted() -> None:
    robot, q, scene = loops.place(np.random.default_rng(0))
    knots = np.tile(q, (21, 1, 1))
    assert loops.wrong_in(robot, scene, knots) == 0
    fast = knots.copy()
    fast[5:, 0, 0] += 0.002
    assert loops.wrong_in(robot, scene, fast) == 1
    long = knots.copy()
    long[:, 0, 2] = 80.0
    assert loops.wrong_in(robot, scene, long) >= 21
    middle = robot.backbone(q)[len(q) * 10]
    assert loops.wrong_in(robot, sn.Scene([sn.Sphere(middle, 5.0)]), knots) == 3
