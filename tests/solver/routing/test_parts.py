"""A robot in two parts: together they are the whole, in shape, limits and targets."""

import numpy as np
import pytest

from sinuous import Robot, Scene, Segment, Target
from sinuous.base.checks import Floats
from sinuous.kernels import packing
from sinuous.kernels.chain.batch import frames_of
from sinuous.kernels.tables import (
    MOUNT,
)
from sinuous.model.poses import pose
from sinuous.problem.problem import Problem
from sinuous.solver.routing.partial_problems import (
    base_position,
    problem_before,
    problem_beyond,
)
from sinuous.solver.routing.reversed_problem import Groups
from tests.helpers import kernel_groups

TOOL = pose((0.02, 0.0, 0.1), direction=(0.3, 0.0, 1.0))
ROBOT = Robot(
    [Segment((0.8, 1.0 + 0.1 * k), 2.0, radius=0.05 + 0.01 * k) for k in range(5)],
    base=pose((1.0, -2.0, 0.5), direction=(0.2, 1.0, -0.4)),
    tool=TOOL,
    mount=1.3,
)
TARGETS = [Target((1.0, 0.0, 0.5), segment=1), Target((2.0, 0.0, 0.5), segment=4), Target((2.0, 1.0, 0.5))]


def groups(robot: Robot) -> Groups:
    return kernel_groups(Problem(robot, TARGETS, Scene()))


def gate(count: int) -> Floats:
    rows = packing.target_row(count, np.array([1.0, 1.0, 1.0]), np.array([0.0, 0.0, 1.0]), None)
    return rows.reshape(-1)


def tip(asked: Groups, q: Floats) -> Floats:
    """Position of the tip, by the compiled kinematics of a group."""
    robot = asked[0]
    frames = np.empty((1, len(q) + 1, 12))
    frames_of(q[None].copy(), robot[-24:-12].reshape(1, 12).copy(), frames)
    end = frames[0, -1]
    place: Floats = end[:9].reshape(3, 3) @ robot[-3:] + end[9:]
    return place


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_what_is_beyond_begins_where_what_is_before_ends(count: int) -> None:
    rng = np.random.default_rng(count)
    asked = groups(ROBOT)
    for _ in range(20):
        q = np.column_stack([rng.uniform(-1.0, 1.0, (5, 2)), rng.uniform(0.8, 1.0, 5)])
        first, second = problem_before(asked, gate(count)), problem_beyond(asked, q[:count])
        ends = ROBOT.forward(q)  # the independent answer is that of the whole robot
        assert np.allclose(tip(first, q[:count]), ends[count - 1, :3, 3])
        assert np.allclose(base_position(second), ends[count - 1, :3, 3])
        assert np.allclose(tip(second, q[count:]), ROBOT.tip(q)[:3, 3])
        assert second[2][MOUNT] == pytest.approx(max(0.0, 1.3 - q[:count, 2].sum()))
