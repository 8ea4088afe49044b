"""What a robot and its targets ask of a route."""

from typing import Any

import numpy as np
import pytest

from sinuous.kernels.fitting.query import route_query
from sinuous.kernels.freespace.query import read_query
from sinuous.kernels.tables import QUERY_WIDTH
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target, Tolerance
from tests.helpers import Floats, as_matrix, kernel_groups, random_pose

ROBOT = Robot(
    [
        Segment((0.2, 1.5), 0.0, radius=0.2),
        Segment(0.5, 0.0, radius=0.2),
        Segment((0.8, 1.2), 2.0, radius=0.15),
        Segment(1.0, 2.5, radius=0.1),
    ],
    mount=0.3,
)


def asked(robot: Robot, targets: Any) -> tuple[bool, Floats]:
    problem = Problem(robot, targets, tolerance=Tolerance(1e-3, 1e-2))
    query = np.full(QUERY_WIDTH, 7.0)
    return route_query(*kernel_groups(problem), query), query


def read(robot: Robot, targets: Any) -> Any:
    found, query = asked(robot, targets)
    assert found
    return read_query(query)


def test_the_numbers_of_a_robot_are_those_of_its_segments() -> None:
    query = read(ROBOT, Target((0.1, 0.2, 2.5)))
    assert query.radius == 0.1
    assert query.shortest == pytest.approx(0.2 + 0.5 + 0.8 + 1.0)
    assert query.longest == pytest.approx(1.5 + 0.5 + 1.2 + 1.0)
    assert query.turn == pytest.approx(min(0.8 / 2.0, 1.0 / 2.5, query.longest / 4.0))
    assert query.free_length == 0.3
    assert (query.straight_min, query.straight_max) == pytest.approx((0.7, 2.0))
    assert query.other_length == pytest.approx(2.0)
    assert query.goal == (0.1, 0.2, 2.5)
    assert query.goal_slack == pytest.approx(1e-3, rel=1e-4)
    assert (query.goal_radius, query.back) == (0.0, (0.0, 0.0, 0.0))


@pytest.mark.parametrize("seed", range(4))
def test_a_tool_moves_the_goal_and_leaves_it_room(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tool, goal = random_pose(rng, 0.2), random_pose(rng)
    robot = Robot.uniform(2, length=1.0, max_bend=1.0, tool=tool)
    length = float(np.linalg.norm(tool[:3, 3]))
    free = read(robot, Target(goal[:3, 3]))
    assert free.goal_radius == pytest.approx(length)
    assert free.goal == pytest.approx(goal[:3, 3])
    fixed = read(robot, Target(goal[:3, 3], rotation=goal[:3, :3]))
    end = as_matrix(goal[:3, :3], goal[:3, 3]) @ np.linalg.inv(tool)
    assert fixed.goal == pytest.approx(end[:3, 3])
    assert fixed.goal_radius == pytest.approx(1e-2 * length)
