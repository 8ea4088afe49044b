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
from sinuous.model.actuators import Tendons
from sinuous.model.poses import pose
from sinuous.problem.problem import Problem
from sinuous.solver.polylines import respaced
from sinuous.solver.routing.chains import find_terminal_poses
from sinuous.solver.routing.growth import GrownChains, settle_chains
from sinuous.solver.routing.partial_problems import (
    Groups,
    join_chains,
    problem_from_pose,
    reverse_chain,
    reverse_problem,
)
from tests.cases import with_each
from tests.helpers import kernel_groups

TOOL = pose((0.1, 0.0, 0.3), direction=(0.3, 0.0, 1.0))
Q = np.array([[0.4, 0.2, 1.0], [-0.5, 0.9, 1.1], [0.3, -0.8, 0.9], [0.2, 0.4, 1.0]])


def groups(robot: Robot, targets: list[Target]) -> Groups:
    return kernel_groups(Problem(robot, targets, Scene()))


@with_each("kind", ["position", "direction", "pose"])
@with_each("tool", [None, TOOL])
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
    begin = find_terminal_poses(here, route)[:1]
    there = reverse_problem(here, begin[0])
    beam = GrownChains(there, respaced(route[::-1], 100)[None], begin, 32, 60.0)
    chains = [beam.complete_chain(i)[0] for i in range(4)]
    ends = settle_chains(there, chains, lambda: 60.0)
    shapes = [reverse_chain(here, there, chain) for chain in ends]
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


def test_mounts_and_limits_of_actuators_are_left_out() -> None:
    segments, tip = [Segment(1.0, 2.0)] * 3, Target((0.5, 0.0, 2.5))
    line = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 3.0), 20)
    driven = [Segment(1.0, 2.0, tendons=Tendons(3, 0.05, displacement=(-0.05, 0.05)))] * 3
    there, bare = (
        reverse_problem(asked, find_terminal_poses(asked, line)[0])
        for asked in (groups(Robot(driven, mount=0.2), [tip]), groups(Robot(segments), [tip]))
    )
    for one, other in zip(there, bare, strict=True):
        assert np.array_equal(one, other)


@pytest.mark.parametrize("cut", [0, 1, 3, 4])
def test_parts_from_either_end_that_meet_are_joined(cut: int) -> None:
    robot = Robot([Segment((0.8, 1.2), 2.0)] * 4, base=pose((1.0, 2.0, 3.0), direction=(0.2, 0.3, 1.0)))
    tip = robot.tip(Q)
    here = groups(robot, [Target(tip[:3, 3], rotation=tip[:3, :3])])
    there = reverse_problem(here, find_terminal_poses(here, robot.backbone(Q, 20))[0])
    back = reverse_chain(there, here, Q)
    np.testing.assert_allclose(join_chains(here, Q[:cut], there, back[: 4 - cut]), Q, atol=1e-12)
    assert np.array_equal(_base(problem_from_pose(there, np.arange(12.0)))[:3, 3], [9.0, 10.0, 11.0])


@pytest.mark.parametrize("asked", [{"direction": (0.0, 0.6, 0.8)}, {"rotation": (0.3, 0.5, -0.4, 0.7)}])
def test_an_elbow_is_passed_along_the_same_tangent_the_other_way(asked: dict[str, tuple[float, ...]]) -> None:
    line = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 3.0), 20)
    elbow = Target((0.0, 0.1, 1.0), segment=1, **asked)
    here = groups(Robot([Segment(1.0, 2.0)] * 3), [elbow, Target((0.5, 0.0, 2.5))])
    row = reverse_problem(here, find_terminal_poses(here, line)[0])[3][0]
    tangent = pose(**asked)[:3, 2]  # type: ignore[arg-type]
    assert row[ORIENTATION] == DIRECTION
    assert row[TARGET_SEGMENT] == 1.0
    np.testing.assert_allclose(row[GOAL : GOAL + 3], -tangent, atol=1e-12)
