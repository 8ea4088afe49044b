"""Laws of robots, for robots and configurations of all kinds."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sinuous as sn
from tests.helpers import Floats

numbers = st.floats(-3.0, 3.0)
vectors = st.tuples(numbers, numbers, numbers)
directions = vectors.filter(lambda v: math.hypot(*v) > 0.1)
poses = st.builds(lambda position, direction: sn.pose(position, direction=direction), vectors, directions)
lengths = st.tuples(st.floats(0.1, 1.0), st.floats(0.0, 1.0)).map(lambda x: (x[0], x[0] + x[1]))
tendons = st.builds(
    lambda count, angle, reach: sn.Tendons(count, 0.05, angle, displacement=(-reach, 2.0 * reach)),
    st.integers(3, 6),
    numbers,
    st.floats(0.0, 0.2),
)
chambers = st.builds(
    lambda count, angle: sn.Chambers(count, 0.05, angle, length=(0.05, 2.5)), st.integers(3, 6), numbers
)
segments = st.builds(
    sn.Segment,
    lengths,
    st.floats(0.0, 3.0),
    st.none() | st.floats(0.0, 4.0),
    st.floats(0.0, 0.1),
    st.none() | tendons,
    st.none() | chambers,
)
robots = st.builds(
    lambda parts, base, tool: sn.Robot(parts, base=base, tool=tool),
    st.lists(segments, min_size=1, max_size=4),
    poses,
    poses,
)


def shapes(count: int) -> st.SearchStrategy[Floats]:
    rows = st.tuples(numbers, numbers, st.floats(0.0, 2.0))
    return st.lists(rows, min_size=count, max_size=count).map(lambda q: np.array(q, np.float64))


posed = robots.flatmap(lambda robot: st.tuples(st.just(robot), shapes(len(robot))))


@given(posed, poses)
def test_a_moved_base_moves_everything(robot_and_q: tuple[sn.Robot, Floats], move: Floats) -> None:
    robot, q = robot_and_q
    moved = sn.Robot(robot.segments, base=move @ robot.base, tool=robot.tool)
    np.testing.assert_allclose(moved.tip(q), move @ robot.tip(q), atol=1e-11)
    there = robot.backbone(q, 3) @ move[:3, :3].T + move[:3, 3]
    np.testing.assert_allclose(moved.backbone(q, 3), there, atol=1e-11)
    np.testing.assert_allclose(moved.jacobian(q), np.kron(np.eye(2), move[:3, :3]) @ robot.jacobian(q), atol=1e-11)
    assert moved.excess(q) == robot.excess(q)


@given(posed, st.floats(0.0, 1.0))
def test_a_segment_may_be_cut_anywhere(robot_and_q: tuple[sn.Robot, Floats], share: float) -> None:
    robot, q = robot_and_q
    cut = sn.Robot([sn.Segment((0.0, 9.0), 9.0)] * (len(robot) + 1), base=robot.base, tool=robot.tool)
    halves = np.concatenate([share * q[:1], (1.0 - share) * q[:1], q[1:]])
    np.testing.assert_allclose(cut.tip(halves), robot.tip(q), atol=1e-11)
    np.testing.assert_allclose(cut.forward(halves)[1:], robot.forward(q), atol=1e-11)


@given(posed)
def test_excess_is_the_worst_violation(robot_and_q: tuple[sn.Robot, Floats]) -> None:
    robot, q = robot_and_q
    violations = robot.violations(q)
    assert robot.excess(q) == pytest.approx(max((amount for _, _, amount in violations), default=0.0), abs=1e-10)
    assert all(1 <= segment <= len(robot) and amount > 0.0 for _, segment, amount in violations)
    assert robot.excess(np.stack([q, q])) == robot.excess(q)
