"""Chains from both ends: within limits, and joined so that both ends are met, whatever is asked of the tip."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from sinuous import Box, Robot, Scene, Segment, Target
from sinuous.model.actuators import Tendons
from sinuous.model.poses import pose
from sinuous.problem.problem import Problem
from sinuous.solver.polylines import respaced
from sinuous.solver.routing.chains import JoinedChains
from sinuous.solver.routing.growth import FIRST_WIDTH, GrownChains
from tests.helpers import Floats, kernel_groups

RADIUS = 0.05
SEGMENTS = [Segment((0.5, 1.0), 2.0, radius=RADIUS)] * 6
HIDDEN = np.array(
    [[0.0, 0.0, 0.8], [0.9, 0.3, 0.8], [-0.7, 0.5, 0.7], [0.2, -0.9, 0.8], [0.8, 0.1, 0.7], [0.0, 0.0, 0.8]]
)


def walled(robot: Robot) -> Scene:
    """Walls with doors about both ends of the hidden shape: tubes that the first and the last segment lie in."""
    walls = []
    for end in (robot.base, robot.forward(HIDDEN)[len(robot) - 1]):
        ahead = -1.0 if end is not robot.base else 1.0
        middle = end[:3, 3] + ahead * 0.35 * end[:3, 2]
        for x, y in ((0.2, 0.0), (-0.2, 0.0), (0.0, 0.2), (0.0, -0.2)):
            size = (0.2 if x else 0.6, 0.2 if y else 0.6, 0.7)
            walls.append(Box(middle + end[:3, :3] @ (x, y, 0.0), size, end[:3, :3]))
    return Scene(walls)


def chains(robot: Robot, targets: list[Target], scene: Scene, width: int, seconds: float = 60.0) -> Iterator[Floats]:
    groups = kernel_groups(Problem(robot, targets, scene))
    line = np.vstack([robot.backbone(HIDDEN, 20), robot.tip(HIDDEN)[None, :3, 3]])
    ends = [20 * target.segment if target.segment is not None else len(line) - 1 for target in targets]
    cuts = [0, *sorted(ends)]
    legs = [respaced(line[a : b + 1], 160) for a, b in pairwise(cuts)]
    return JoinedChains(groups, np.stack(legs), lambda: seconds).chains_of_width(width)


def asked_of(kind: str, tip: Floats) -> dict[str, Any]:
    return {"position": {}, "direction": {"direction": tip[:3, 2]}, "rotation": {"rotation": tip[:3, :3]}}[kind]


@pytest.mark.parametrize("kind", ["position", "direction", "rotation"])
@pytest.mark.parametrize("tool", [None, pose((0.05, 0.0, 0.2), direction=(0.2, 0.0, 1.0))])
def test_some_chain_meets_the_target_and_all_are_within_limits(kind: str, tool: Floats | None) -> None:
    robot = Robot(SEGMENTS, base=pose((1.0, 2.0, 0.5), direction=(0.2, -0.3, 1.0)), tool=tool)
    tip = robot.tip(HIDDEN)
    found = list(chains(robot, [Target(tip[:3, 3], **asked_of(kind, tip))], walled(robot), 16))
    assert found
    assert max(robot.excess(q) for q in found) <= 1e-9
    ends = [robot.tip(q) for q in found]
    off = [float(np.linalg.norm(end[:3, 3] - tip[:3, 3])) for end in ends]
    best = ends[int(np.argmin(off))]
    assert min(off) < 0.01 * robot.mean_length
    if kind != "position":
        assert best[:3, 2] @ tip[:3, 2] > 0.99
    if kind == "rotation":
        assert np.trace(best[:3, :3].T @ tip[:3, :3]) > 2.95


def test_a_mount_and_limits_of_actuators_are_no_hindrance() -> None:
    lines = Tendons(3, 0.03, displacement=(-0.2, 0.2))
    robot = Robot([Segment((0.5, 1.0), 2.0, radius=RADIUS, tendons=lines)] * 6, mount=0.3)
    tip = robot.tip(HIDDEN)
    found = list(chains(robot, [Target(tip[:3, 3])], walled(robot), 8))
    assert min(np.linalg.norm(robot.tip(q)[:3, 3] - tip[:3, 3]) for q in found) < 0.05 * robot.mean_length


def test_chains_lead_past_an_elbow() -> None:
    robot = Robot(SEGMENTS)
    tip, elbow = robot.tip(HIDDEN)[:3, 3], robot.forward(HIDDEN)[2, :3, 3]
    found = list(chains(robot, [Target(elbow, segment=3), Target(tip)], walled(robot), 16))
    off = [
        np.linalg.norm(robot.forward(q)[2, :3, 3] - elbow) + np.linalg.norm(robot.tip(q)[:3, 3] - tip) for q in found
    ]
    assert min(off) < 0.01 * robot.mean_length


def test_an_elbow_within_a_tube_is_passed_either_way() -> None:
    elbow, tip = np.array([1.2, 0.0, 1.5]), np.array([1.2, 1.0, 1.8])
    sides = ((0.0, 0.2), (0.0, -0.2), (0.2, 0.0), (-0.2, 0.0))
    walls = [Box((1.2, y, 1.5 + z), (0.7, 0.2 if y else 0.6, 0.2 if z else 0.6)) for y, z in sides]
    robot, scene = Robot(SEGMENTS[:4] * 2), Scene(walls)
    groups = kernel_groups(Problem(robot, [Target(elbow, segment=4), Target(tip)], scene))
    legs = np.stack([respaced(np.array(ends), 160) for ends in ([np.zeros(3), elbow], [elbow, tip])])
    passing = [robot.forward(q)[3] for q in JoinedChains(groups, legs, lambda: 60.0).chains_of_width(FIRST_WIDTH)]
    along = [pose[0, 2] for pose in passing if np.linalg.norm(pose[:3, 3] - elbow) < 0.01 * RADIUS]
    assert min(along) < -0.9
    assert max(along) > 0.9


def test_chains_begin_with_a_root_and_end_where_their_frames_say() -> None:
    robot = Robot(SEGMENTS)
    groups = kernel_groups(Problem(robot, [Target((1.0, 0.0, 4.0))], Scene([])))
    legs = respaced(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [1.0, 0.0, 4.0]]), 160)[None]
    roots = np.stack([np.append(np.eye(3).ravel(), np.zeros(3))] * 2)
    roots[1, :9] = pose(direction=(0.3, 0.0, 1.0))[:3, :3].ravel()
    beam = GrownChains(groups, legs, roots, FIRST_WIDTH, 60.0)
    assert beam.counts[0] == 2
    assert beam.counts.tolist()[1:] == [FIRST_WIDTH] * 6
    for k in (1, 3, 6):
        for i in range(FIRST_WIDTH):
            q, root = beam.chain(k, i)
            base = np.eye(4)
            base[:3, :3], base[:3, 3] = root[:9].reshape(3, 3), root[9:]
            end = Robot(SEGMENTS[:k], base=base).tip(q)
            np.testing.assert_allclose(beam.frames[k, i], np.append(end[:3, :3].ravel(), end[:3, 3]), atol=1e-9)


def test_without_time_there_is_none() -> None:
    robot = Robot(SEGMENTS)
    assert not list(chains(robot, [Target(robot.tip(HIDDEN)[:3, 3])], Scene([]), 8, seconds=0.0))
