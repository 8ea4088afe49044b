"""Chains turned round: the same curve, from the other end."""

import numpy as np
import pytest

from sinuous.kernels.growing.turning import turn_round
from sinuous.model.poses import pose
from sinuous.model.robot import Robot, robot_group
from sinuous.model.segment import Segment


@pytest.mark.parametrize("seed", range(4))
def test_a_chain_and_the_one_turned_round_are_one_curve(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 1 + 2 * seed
    segments = [Segment((0.5, 2.0), 4.0)] * n
    robot = Robot(segments, base=pose(rng.normal(size=3), rotation=rng.normal(size=4)))
    q = np.column_stack([rng.uniform(-1.5, 1.5, (n, 2)), rng.uniform(0.5, 2.0, n)])
    tip = robot.tip(q)
    flip = np.diag([1.0, -1.0, -1.0, 1.0])
    roll = pose(rotation=(np.cos(0.4), 0.0, 0.0, np.sin(0.4)))  # nothing may hang on the angle that it begins with
    other = Robot(segments, base=tip @ roll @ flip)
    back, there = np.empty((n, 3)), np.empty((n, 3))
    groups = robot_group(robot), robot_group(other)
    # From the robot's own chain to that of the turned one, and back.
    turn_round(groups[1], groups[0], q, back)
    assert np.allclose(robot.backbone(q, 5), other.backbone(back, 5)[::-1])
    turn_round(*groups, back, there)
    assert np.allclose(there, q)
