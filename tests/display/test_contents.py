"""Things are sorted, and obstacles that move are where they are when the robot is where it is."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.display.contents import gather

pytest.importorskip("matplotlib").use("agg")

ROBOT = sn.Robot.uniform(2, (0.8, 1.2), radius=0.05)
BALL = sn.Moving(sn.Sphere((0, 0, 0), 0.2), [0, 2, 4], [(1, 1, 1), (1, -1, 1), (1, 1, 1)])
DUST = sn.Moving(sn.PointCloud(np.eye(3) * 0.1, 0.02), [0, 4], [(-1, 1, 1), (-1, -1, 1)])
KNOTS = [[[0.0, 0.0, 1.0]] * 2, [[-0.3, 0.0, 1.0]] * 2]


def test_waypoints_are_joined_by_lines_only_where_the_tip_goes_straight() -> None:
    arm = sn.on_stage(sn.Robot.uniform(3, 60, max_bend=1.8), 150)
    turn = np.linspace(0.0, 1.0, 20)[:, None]
    curve = np.concatenate([40 * (1 - np.cos(2 * turn)), 0.0 * turn, 120 * turn], axis=1)
    bent = gather([sn.follow_the_leader(arm, curve)])
    assert bent.paths == []
    assert len(bent.targets) == 2
    robot = sn.Robot.uniform(3, (0.8, 1.2), max_bend=2)
    straight = gather([sn.track(robot, [sn.Target((1, y, 2)) for y in (0.0, 0.2)])])
    assert len(straight.paths) == 1


def test_obstacles_are_where_they_are_at_a_share_of_the_motion() -> None:
    contents = gather([sn.Motion(ROBOT, KNOTS, [BALL, DUST], times=[1.0, 3.0])])
    for share, when in ((0.0, 1.0), (0.5, 2.0), (1.0, 3.0)):
        for shown, moving in zip(contents.obstacles_at(share), (BALL, DUST), strict=True):
            assert shown.equals(moving.at(when))
    (alone,) = gather([sn.Scene([BALL])]).obstacles_at(0.7)
    assert alone.equals(BALL.at(0.0))


@pytest.mark.parametrize(
    ("things", "message"),
    [
        ((), "things: expected something to draw"),
        ((ROBOT, ["x"]), r"things\[1\]\[0\]: expected a robot, scene"),
        ((np.zeros((2, 3)),), r"things\[0\]: expected an array of configurations right after its robot"),
        ((ROBOT, np.zeros((3, 3))), r"things\[1\]: expected"),
        ((sn.Target(direction=(0, 0, 1)),), "a robot before a target without a position"),
        (([ROBOT] * 101,), r"len\(robots\): expected"),
    ],
)
def test_what_cannot_be_drawn_is_named(things: Any, message: str) -> None:
    with pytest.raises(sn.InputError, match=message):
        gather(things)


def test_a_job_brings_its_robot_its_targets_or_its_path() -> None:
    start = [[0.0, 0.0, 1.0]] * 2
    for asked, counts in (
        ({"target": sn.Target((0, 0, 2))}, (1, 1, 0)),
        ({"path": [sn.Target((0, 0, 2)), sn.Target((0, 0.1, 2))]}, (1, 0, 1)),
        ({"start": start, "goal": start}, (1, 0, 0)),
    ):
        contents = gather([sn.Job(ROBOT, **asked)])
        assert (len(contents.arms), len(contents.targets), len(contents.paths)) == counts


def test_every_kind_of_picture_shows_them(tmp_path: Path) -> None:
    motion = sn.Motion(ROBOT, KNOTS, [BALL, DUST, sn.Sphere((0, 3, 0), 0.1)], times=[1.0, 3.0])
    sn.plot(motion).figure.savefig(tmp_path / "still.png")
    sn.animate(motion, path=tmp_path / "way.gif", seconds=0.3, fps=10)
    sn.diagram(motion, "clearance")
    assert all((tmp_path / name).stat().st_size > 1000 for name in ("still.png", "way.gif"))
