"""A robot in two parts: together they are the whole, in shape, limits and targets."""

import numpy as np
import pytest

from sinuous import Chambers, Robot, Scene, Segment, Target, Tendons
from sinuous.base.checks import Floats
from sinuous.kernels import packing
from sinuous.kernels.chain.batch import frames_of
from sinuous.kernels.tables import (
    DIRECTION,
    FREE,
    GOAL,
    MOUNT,
    ORIENTATION,
    ROBOT_HEADER,
    SEGMENT_WIDTH,
    TARGET_SEGMENT,
    UNIT,
)
from sinuous.model.poses import pose
from sinuous.problem.problem import Problem
from sinuous.solver.routing.partial_problems import (
    Groups,
    base_position,
    problem_before,
    problem_beyond,
    problem_up_to,
    with_end_tangent,
)
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


@pytest.mark.parametrize("count", [2, 5])
def test_a_tangent_is_asked_for_where_no_target_says_one(count: int) -> None:
    tangent = np.array([0.0, 0.6, 0.8])
    part = problem_up_to(groups(ROBOT), count)
    led = with_end_tangent(part, tangent)
    assert part[2][UNIT] == pytest.approx(sum(0.9 + 0.05 * k for k in range(count)))
    assert np.array_equal(led[3][:, :ORIENTATION], part[3][:, :ORIENTATION])
    at_end = np.isin(led[3][:, TARGET_SEGMENT], (-1.0, count - 1.0))
    assert (led[3][at_end, ORIENTATION] == DIRECTION).all()
    assert np.array_equal(led[3][~at_end], part[3][~at_end])
    assert np.array_equal(led[3][at_end, GOAL : GOAL + 3], np.tile(tangent, (at_end.sum(), 1)))
    assert (part[3][:, ORIENTATION] == FREE).all()  # what was given is not changed
    assert all(np.array_equal(one, other) for one, other in zip(with_end_tangent(led, -tangent), led, strict=True))


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_segments_and_targets_are_shared_out(count: int) -> None:
    asked = groups(ROBOT)
    q = np.tile([0.0, 0.0, 0.9], (count, 1))
    first, second = problem_before(asked, gate(count)), problem_beyond(asked, q)
    rows = [part[0][ROBOT_HEADER : ROBOT_HEADER + SEGMENT_WIDTH * int(part[0][0])] for part in (first, second)]
    assert np.array_equal(np.concatenate(rows), ROBOT.limits.ravel())
    assert first[2][UNIT] + second[2][UNIT] == pytest.approx(ROBOT.mean_length)
    assert np.array_equal(first[3][-1, 1:], gate(count)[1:])
    assert first[3][-1, TARGET_SEGMENT] == -1.0
    ends = [*first[3][:-1, TARGET_SEGMENT], *(np.where(second[3][:, 0] < 0.0, 4.0 - count, second[3][:, 0]) + count)]
    assert ends == [0.0, 3.0, 4.0]


def test_limits_of_actuators_that_see_both_parts_are_left_out() -> None:
    tendons, chambers = Tendons(3, 0.05, displacement=(-0.2, 0.2)), Chambers(3, 0.05, length=(0.5, 1.5))
    pulled, blown = Segment((0.8, 1.2), 2.0, tendons=tendons), Segment((0.8, 1.2), 2.0, chambers=chambers)
    robot = Robot([blown, pulled, blown], radius=0.05)
    asked = groups_of_tip(robot)
    q = np.tile([0.0, 0.0, 1.0], (2, 1))
    for part, segments in ((problem_before(asked, gate(2)), 2), (problem_beyond(asked, q), 1)):
        assert part[0][0] == segments
        own = part[0][ROBOT_HEADER + SEGMENT_WIDTH * segments : -24].reshape(-1, 7)
        assert len(own) == part[0][1] > 0
        assert (own[:, 0] == own[:, 1]).all()
        assert set(own[:, 0]) <= set(range(segments))


def groups_of_tip(robot: Robot) -> Groups:
    return kernel_groups(Problem(robot, [Target((0.0, 0.0, 2.5))], Scene()))
