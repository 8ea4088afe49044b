"""Obstacles that move are drawn where they are when the robot is where it is."""

from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.display.contents import gather

pytest.importorskip("matplotlib").use("agg")

ROBOT = sn.Robot.uniform(2, (0.8, 1.2), radius=0.05)
BALL = sn.Moving(sn.Sphere((0, 0, 0), 0.2), [0, 2, 4], [(1, 1, 1), (1, -1, 1), (1, 1, 1)])
DUST = sn.Moving(sn.PointCloud(np.eye(3) * 0.1, 0.02), [0, 4], [(-1, 1, 1), (-1, -1, 1)])
KNOTS = [[[0.0, 0.0, 1.0]] * 2, [[-0.3, 0.0, 1.0]] * 2]


def test_obstacles_are_where_they_are_at_a_share_of_the_motion() -> None:
    contents = gather([sn.Motion(ROBOT, KNOTS, [BALL, DUST], times=[1.0, 3.0])])
    for share, when in ((0.0, 1.0), (0.5, 2.0), (1.0, 3.0)):
        for shown, moving in zip(contents.obstacles_at(share), (BALL, DUST), strict=True):
            assert shown.equals(moving.at(when))
    (alone,) = gather([sn.Scene([BALL])]).obstacles_at(0.7)
    assert alone.equals(BALL.at(0.0))


def test_every_kind_of_picture_shows_them(tmp_path: Path) -> None:
    motion = sn.Motion(ROBOT, KNOTS, [BALL, DUST, sn.Sphere((0, 3, 0), 0.1)], times=[1.0, 3.0])
    sn.plot(motion).figure.savefig(tmp_path / "still.png")
    sn.animate(motion, path=tmp_path / "way.gif", seconds=0.3, fps=10)
    sn.diagram(motion, "clearance")
    assert all((tmp_path / name).stat().st_size > 1000 for name in ("still.png", "way.gif"))
