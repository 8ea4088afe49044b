"""Problems turned round: what is solved there is solved here."""

import numpy as np

from sinuous import Robot, Scene, Segment, Target
from sinuous.kernels.tables import (
    DIRECTION,
    GOAL,
    ORIENTATION,
    POSE_POSITION,
    POSE_WIDTH,
    ROTATION,
    TARGET_POSITION,
    TARGET_SEGMENT,
)
from sinuous.model.poses import pose
from sinuous.problem.problem import Problem
from sinuous.solver.routing.reversed_problem import (
    Groups,
    reverse_chain,
    reverse_problem,
)
from sinuous.solver.routing.terminal_poses import find_terminal_poses
from tests.helpers import kernel_groups

TOOL = pose((0.1, 0.0, 0.3), direction=(0.3, 0.0, 1.0))
Q = np.array([[0.4, 0.2, 1.0], [-0.5, 0.9, 1.1], [0.3, -0.8, 0.9], [0.2, 0.4, 1.0]])


def groups(robot: Robot, targets: list[Target]) -> Groups:
    return kernel_groups(Problem(robot, targets, Scene()))


def test_where_a_rotation_is_asked_for_the_base_is_one_to_end_with() -> None:
    """The hidden shape, turned round, ends at the base turned round: with its rotation, not just its tangent."""
    robot = Robot([Segment((0.8, 1.2), 2.0)] * 4, base=pose((1.0, 2.0, 3.0), rotation=(0.3, 0.5, -0.4, 0.7)), tool=TOOL)
    tip = robot.tip(Q)
    asked = groups(robot, [Target(tip[:3, 3], rotation=tip[:3, :3])])
    route = np.vstack([robot.backbone(Q, 20), tip[:3, 3]])
    there = reverse_problem(asked, find_terminal_poses(asked, route)[0])
    q = reverse_chain(there, asked, Q)  # to turn round twice is to do nothing
    other = Robot([Segment((0.8, 1.2), 2.0)] * 4, base=_base(there))
    row = there[3][0]
    assert row[ORIENTATION] == ROTATION
    np.testing.assert_allclose(other.tip(q)[:3, 3], robot.base[:3, 3], atol=1e-9)
    np.testing.assert_allclose(other.tip(q)[:3, :3], row[GOAL : GOAL + 9].reshape(3, 3), atol=1e-9)
    elbow = robot.forward(Q)[0, :3, 3]
    with_elbow = groups(robot, [Target(tip[:3, 3], rotation=tip[:3, :3]), Target(elbow, segment=1)])
    bent = reverse_problem(with_elbow, find_terminal_poses(with_elbow, route)[0])
    number = int(bent[3][0, TARGET_SEGMENT])
    np.testing.assert_allclose(other.forward(q)[number, :3, 3], elbow, atol=1e-9)
    np.testing.assert_allclose(bent[3][0, TARGET_POSITION : TARGET_POSITION + 3], elbow, atol=1e-9)
    np.testing.assert_allclose(bent[3][1], row)
    towards = groups(robot, [Target(tip[:3, 3], direction=tip[:3, 2])])
    assert reverse_problem(towards, find_terminal_poses(towards, route)[0])[3][0, ORIENTATION] == DIRECTION


def _base(there: Groups) -> np.ndarray:
    flat = there[0][-2 * POSE_WIDTH : -POSE_WIDTH]
    base = np.eye(4)
    base[:3, :3], base[:3, 3] = flat[:POSE_POSITION].reshape(3, 3), flat[POSE_POSITION:]
    return base
