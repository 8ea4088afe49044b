"""Problems turned round: what is solved there is solved here."""

import numpy as np
import pytest

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
from sinuous.poses import pose
from sinuous.problem.problem import Problem
from sinuous.robot.actuators import Tendons
from sinuous.solving.polylines import respaced
from sinuous.solving.routing.growth import Beam, grown, settled
from sinuous.solving.routing.turned import Groups, turned, turned_back
from tests.helpers import kernel_groups

TOOL = pose((0.1, 0.0, 0.3), direction=(0.3, 0.0, 1.0))
Q = np.array([[0.4, 0.2, 1.0], [-0.5, 0.9, 1.1], [0.3, -0.8, 0.9], [0.2, 0.4, 1.0]])


def groups(robot: Robot, targets: list[Target]) -> Groups:
    return kernel_groups(Problem(robot, targets, Scene()))


@pytest.mark.parametrize("kind", ["position", "direction", "pose"])
@pytest.mark.parametrize("tool", [None, TOOL])
def test_a_chain_from_the_target_ends_at_the_target(kind: str, tool: np.ndarray | None) -> None:
    segments = [Segment((0.8, 1.2), max_bend) for max_bend in (2.0, 1.5, 2.2, 1.8)]
    robot = Robot(segments, base=pose((1.0, 2.0, 3.0), direction=(0.2, 0.3, 1.0)), tool=tool)
    tip = robot.tip(Q)
    target = {
        "position": Target(tip[:3, 3]),
        "direction": Target(tip[:3, 3], direction=tip[:3, 2]),
        "pose": Target(tip[:3, 3], rotation=tip[:3, :3]),
    }[kind]
    here = groups(robot, [target])
    route = np.vstack([robot.backbone(Q, 20), tip[:3, 3]])
    there = turned(here, route)
    assert there is not None
    chains = grown(there, respaced(route[::-1], 100)[None], Beam(4, 32), 60.0)
    ends = settled(there, chains, lambda: 60.0)
    shapes = [turned_back(here, there, chain) for chain in ends]
    assert max(robot.excess(q) for q in shapes) <= 1e-12
    found = min((robot.tip(q) for q in shapes), key=lambda end: float(np.linalg.norm(end[:3, 3] - tip[:3, 3])))
    assert np.linalg.norm(found[:3, 3] - tip[:3, 3]) < 0.05
    if kind != "position":
        assert found[:3, 2] @ tip[:3, 2] > 0.995


def test_where_a_rotation_is_asked_for_the_base_is_one_to_end_with() -> None:
    """The hidden shape, turned round, ends at the base turned round: with its rotation, not just its tangent."""
    robot = Robot([Segment((0.8, 1.2), 2.0)] * 4, base=pose((1.0, 2.0, 3.0), rotation=(0.3, 0.5, -0.4, 0.7)), tool=TOOL)
    tip = robot.tip(Q)
    asked = groups(robot, [Target(tip[:3, 3], rotation=tip[:3, :3])])
    route = np.vstack([robot.backbone(Q, 20), tip[:3, 3]])
    there = turned(asked, route)
    assert there is not None
    q = turned_back(there, asked, Q)  # to turn round twice is to do nothing
    other = Robot([Segment((0.8, 1.2), 2.0)] * 4, base=_base(there))
    row = there[3][0]
    assert row[ORIENTATION] == ROTATION
    np.testing.assert_allclose(other.tip(q)[:3, 3], robot.base[:3, 3], atol=1e-9)
    np.testing.assert_allclose(other.tip(q)[:3, :3], row[GOAL : GOAL + 9].reshape(3, 3), atol=1e-9)
    elbow = robot.forward(Q)[0, :3, 3]
    bent = turned(groups(robot, [Target(tip[:3, 3], rotation=tip[:3, :3]), Target(elbow, segment=1)]), route)
    assert bent is not None
    number = int(bent[3][0, TARGET_SEGMENT])
    np.testing.assert_allclose(other.forward(q)[number, :3, 3], elbow, atol=1e-9)
    np.testing.assert_allclose(bent[3][0, TARGET_POSITION : TARGET_POSITION + 3], elbow, atol=1e-9)
    np.testing.assert_allclose(bent[3][1], row)
    towards = groups(robot, [Target(tip[:3, 3], direction=tip[:3, 2])])
    other_groups = turned(towards, route)
    assert other_groups is not None
    assert other_groups[3][0, ORIENTATION] == DIRECTION


def _base(there: Groups) -> np.ndarray:
    flat = there[0][-2 * POSE_WIDTH : -POSE_WIDTH]
    base = np.eye(4)
    base[:3, :3], base[:3, 3] = flat[:POSE_POSITION].reshape(3, 3), flat[POSE_POSITION:]
    return base


def test_what_is_not_turned_is_left() -> None:
    segments = [Segment(1.0, 2.0)] * 3
    line = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 3.0), 20)
    tip = Target((0.5, 0.0, 2.5))
    assert turned(groups(Robot(segments), [tip]), line) is not None
    assert turned(groups(Robot(segments), [Target((0.0, 0.0, 1.0), segment=2)]), line) is None
    driven = [Segment(1.0, 2.0, tendons=Tendons(3, 0.05, displacement=(-0.05, 0.05)))] * 3
    there = turned(groups(Robot(driven, mount=0.2), [tip]), line)
    assert there is not None
    bare = turned(groups(Robot(segments), [tip]), line)
    assert bare is not None
    for one, other in zip(there, bare, strict=True):
        assert np.array_equal(one, other)


@pytest.mark.parametrize("asked", [{"direction": (0.0, 0.6, 0.8)}, {"rotation": (0.3, 0.5, -0.4, 0.7)}])
def test_an_elbow_is_passed_along_the_same_tangent_the_other_way(asked: dict[str, tuple[float, ...]]) -> None:
    line = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 3.0), 20)
    elbow = Target((0.0, 0.1, 1.0), segment=1, **asked)
    here = groups(Robot([Segment(1.0, 2.0)] * 3), [elbow, Target((0.5, 0.0, 2.5))])
    there = turned(here, line)
    assert there is not None
    row = there[3][0]
    tangent = pose(**asked)[:3, 2]  # type: ignore[arg-type]
    assert row[ORIENTATION] == DIRECTION
    assert row[TARGET_SEGMENT] == 1.0
    np.testing.assert_allclose(row[GOAL : GOAL + 3], -tangent, atol=1e-12)


def test_no_chains_are_grown_along_more_legs_than_there_are_ends_of_segments_for() -> None:
    both = [Target((0.5, 0.0, 2.5)), Target((0.0, 0.0, 1.0), segment=3)]
    legs = np.stack([respaced(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.5], [0.5, 0.0, 2.5]]), 100)] * 2)
    here = groups(Robot([Segment(1.0, 2.0)] * 3), both)
    assert len(grown(here, legs, Beam(4, 32), 60.0)) == 0
    assert len(grown(here, legs[:1], Beam(4, 32), 60.0)) > 0


@pytest.mark.parametrize("count", [2, 3, 100])
def test_a_route_within_the_length_of_the_tool_and_one_of_two_points_are_turned(count: int) -> None:
    robot = Robot([Segment((0.8, 1.2), 2.0)] * 4, tool=pose((0.0, 0.0, 3.0)))
    route = np.linspace((0.0, 0.0, 0.0), (0.0, 0.5, 2.0), count)
    there = turned(groups(robot, [Target(route[-1])]), route)
    assert there is not None
    assert not np.isnan(there[0]).any()


def test_a_route_without_a_direction_is_not_turned() -> None:
    robot = Robot([Segment((0.8, 1.2), 2.0)] * 4)
    assert turned(groups(robot, [Target((0, 0, 1))]), np.tile([0.0, 0.0, 1.0], (5, 1))) is None
