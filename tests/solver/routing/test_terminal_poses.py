"""Roots: each puts the tip where it is asked to be, and in a tube some lie along it."""

import numpy as np
import pytest

from sinuous import Box, Robot, Scene, Segment, Target
from sinuous.kernels.tables import POSE_POSITION
from sinuous.model.poses import pose
from sinuous.problem.problem import Problem
from sinuous.solver.routing.chains import APART, ENOUGH, IN_WALL, MOST, find_terminal_poses
from sinuous.solver.routing.partial_problems import FLIP
from tests.cases import with_each
from tests.helpers import Floats, kernel_groups

SEGMENTS = [Segment((0.8, 1.2), 2.0, radius=0.1)] * 4
ASIDE = pose((0.15, 0.05, 0.3), direction=(0.3, 0.0, 1.0))
GOAL = pose((0.4, 0.2, 3.0), rotation=(0.3, 0.5, -0.4, 0.7))
ROUTE = np.linspace((0.0, 0.0, 0.0), (0.4, 0.2, 3.0), 40)


def ends(tool: Floats | None, scene: Scene, **asked: Floats) -> Floats:
    """Poses (r, 4, 4) of the end of the backbone at the target."""
    target = Target(GOAL[:3, 3], **asked)  # type: ignore[arg-type]
    found = find_terminal_poses(kernel_groups(Problem(Robot(SEGMENTS, tool=tool), [target], scene)), ROUTE)
    frames = np.tile(np.eye(4), (len(found), 1, 1))
    frames[:, :3, :3] = found[:, :POSE_POSITION].reshape(-1, 3, 3) @ FLIP
    frames[:, :3, 3] = found[:, POSE_POSITION:]
    return frames


@with_each("tool", [None, pose((0.0, 0.0, 0.4)), ASIDE])
@with_each("asked", [{}, {"direction": GOAL[:3, 2]}, {"rotation": GOAL[:3, :3]}])
def test_every_root_meets_what_is_asked(tool: Floats | None, asked: dict[str, Floats]) -> None:
    found = ends(tool, Scene([]), **asked) @ (np.eye(4) if tool is None else tool)
    assert 1 <= len(found) <= MOST
    np.testing.assert_allclose(found[:, :3, 3], np.tile(GOAL[:3, 3], (len(found), 1)), atol=1e-12)
    np.testing.assert_allclose(
        found[:, :3, :3] @ found[:, :3, :3].swapaxes(1, 2), np.tile(np.eye(3), (len(found), 1, 1)), atol=1e-12
    )
    if "direction" in asked:
        np.testing.assert_allclose(found[:, :3, 2], np.tile(GOAL[:3, 2], (len(found), 1)), atol=1e-12)
    if "rotation" in asked:
        np.testing.assert_allclose(found[:, :3, :3], GOAL[None, :3, :3], atol=1e-12)


def test_in_the_open_the_first_root_goes_on_along_the_route() -> None:
    found = ends(None, Scene([]))
    ahead = ROUTE[-1] / np.linalg.norm(ROUTE[-1])
    np.testing.assert_allclose(found[0, :3, 2], ahead, atol=1e-9)
    cosines = found[:, :3, 2] @ found[:, :3, 2].T
    assert np.arccos(np.clip(cosines, -1.0, 1.0))[~np.eye(len(found), dtype=bool)].min() > APART


@pytest.mark.parametrize("tool", [None, ASIDE, pose((0.0, 0.0, 0.4))])
def test_in_a_channel_the_first_roots_lie_along_it_whatever_the_route_says(tool: Floats | None) -> None:
    """A channel along x of two radii, where the route arrives across it."""
    walls = [
        Box(GOAL[:3, 3] + np.array(at), size)
        for at, size in (
            ((0.0, 0.0, 0.3), (6.0, 2.0, 0.2)),
            ((0.0, 0.0, -0.3), (6.0, 2.0, 0.2)),
            ((0.0, 0.3, 0.0), (6.0, 0.2, 2.0)),
            ((0.0, -0.3, 0.0), (6.0, 0.2, 2.0)),
        )
    ]
    found = ends(tool, Scene(walls))
    assert abs(found[0, 0, 2]) > 0.9
    room = Scene(walls).distance(found[:, :3, 3])
    assert room.min() >= (ENOUGH - IN_WALL) * 0.1, "none begins in a wall, nor beyond one that the tool leads through"


def test_where_the_tip_is_not_asked_to_be_somewhere_or_the_route_has_no_direction_there_is_none() -> None:
    robot = Robot(SEGMENTS)
    inside = kernel_groups(Problem(robot, [Target((0.0, 0.0, 1.0), segment=2)], Scene([])))
    assert len(find_terminal_poses(inside, ROUTE)) == 0
    tip = kernel_groups(Problem(robot, [Target((0.0, 0.0, 1.0))], Scene([])))
    assert len(find_terminal_poses(tip, np.tile([0.0, 0.0, 1.0], (5, 1)))) == 0


@pytest.mark.parametrize("count", [2, 3, 100])
def test_a_route_within_the_length_of_the_tool_has_roots(count: int) -> None:
    robot = Robot(SEGMENTS, tool=pose((0.0, 0.0, 3.0)))
    route = np.linspace((0.0, 0.0, 0.0), (0.0, 0.5, 2.0), count)
    found = find_terminal_poses(kernel_groups(Problem(robot, [Target(route[-1])], Scene([]))), route)
    assert len(found) > 0
    assert not np.isnan(found).any()
