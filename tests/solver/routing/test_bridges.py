"""Bridges: chains out of two tubes, with the open between them, meet both ends and are proved."""

from typing import Any

import numpy as np
import pytest

from sinuous import Box, Robot, Scene, Segment, Target
from sinuous.model.poses import pose
from sinuous.problem.problem import Problem
from sinuous.solver.polylines import respaced
from sinuous.solver.routing.chains import OPEN, bridge_chains, find_terminal_poses
from sinuous.solver.routing.growth import GrownChains
from sinuous.solver.routing.partial_problems import reverse_problem
from tests.helpers import Floats, kernel_groups

RADIUS = 0.05
SEGMENTS = [Segment((0.6, 0.9), 2.0, radius=RADIUS)] * 8
STRAIGHT = [[0.0, 0.0, 0.8]] * 2
HIDDEN = np.array([*STRAIGHT, [1.2, 0.3, 0.7], [-0.7, 0.8, 0.8], [0.2, -1.1, 0.7], [0.8, 0.4, 0.8], *STRAIGHT])
WRONG = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, -4.0), 160)
"""A route that leads elsewhere."""


def channel(begin: Floats, length: float) -> list[Box]:
    """Four boxes about a straight line along z of a pose."""
    middle = begin[:3, 3] + 0.5 * length * begin[:3, 2]
    return [
        Box(middle + begin[:3, :3] @ (x, y, 0.0), (0.2 if x else 0.6, 0.2 if y else 0.6, length), begin[:3, :3])
        for x, y in ((0.18, 0.0), (-0.18, 0.0), (0.0, 0.18), (0.0, -0.18))
    ]


@pytest.mark.parametrize("both", [True, False])
@pytest.mark.parametrize("kind", ["position", "direction", "rotation"])
def test_a_bridge_leads_from_one_tube_into_the_other_along_whatever_route(kind: str, both: bool) -> None:
    robot = Robot(SEGMENTS, base=pose((1.0, 2.0, 0.5), direction=(0.2, -0.3, 1.0)))
    tip, frames = robot.tip(HIDDEN), robot.forward(HIDDEN)
    scene = Scene([*channel(robot.base, 1.3), *(channel(frames[5], 1.9) if both else [])])
    asked: dict[str, Any] = {
        "position": {},
        "direction": {"direction": tip[:3, 2]},
        "rotation": {"rotation": tip[:3, :3]},
    }[kind]
    target = Target(tip[:3, 3], **asked)
    groups = kernel_groups(Problem(robot, [target], scene))
    legs = respaced(WRONG + robot.base[:3, 3], 160)[None]
    begin = find_terminal_poses(groups, legs[0])
    other = reverse_problem(groups, begin[0])
    base = np.append(robot.base[:3, :3].ravel(), robot.base[:3, 3])[None]
    ahead = GrownChains(groups, legs, base, 16, 60.0, OPEN)
    behind = GrownChains(other, legs[:, ::-1].copy(), begin, 16, 60.0, OPEN)
    assert ahead.open
    assert behind.open
    assert 0 < ahead.outside()[0] < 5
    chains = list(bridge_chains(groups, other, ahead, behind, 16, lambda: 60.0))
    assert chains
    for q in chains:
        end = robot.tip(q)
        assert robot.excess(q) <= 1e-9
        assert np.linalg.norm(end[:3, 3] - tip[:3, 3]) < 1e-3 * robot.mean_length
        if kind != "position":
            assert end[:3, 2] @ tip[:3, 2] > 0.999
        if kind == "rotation":
            assert np.trace(end[:3, :3].T @ tip[:3, :3]) > 2.99
    assert max(scene.distance(robot.backbone(q, 60)[5:]).min() for q in chains) > 0.5 * RADIUS


def test_in_the_open_there_is_nothing_to_bridge() -> None:
    robot = Robot(SEGMENTS)
    tip = robot.tip(HIDDEN)
    groups = kernel_groups(Problem(robot, [Target(tip[:3, 3])], Scene([Box((9.0, 9.0, 9.0), (1.0, 1.0, 1.0))])))
    legs = respaced(robot.backbone(HIDDEN, 20), 160)[None]
    begin = find_terminal_poses(groups, legs[0])
    ahead = GrownChains(groups, legs, np.append(np.eye(3).ravel(), np.zeros(3))[None], 4, 60.0, OPEN)
    behind = GrownChains(reverse_problem(groups, begin[0]), legs[:, ::-1].copy(), begin, 4, 60.0, OPEN)
    assert ahead.outside()[0] == behind.outside()[0] == 0
    assert list(bridge_chains(groups, reverse_problem(groups, begin[0]), ahead, behind, 4, lambda: 60.0)) == []
