"""Robots cut in two at the narrowest place of a route: parts that meet there, and chains through doors and channels."""

import numpy as np
import pytest

from sinuous import Box, Robot, Scene, Segment, Target
from sinuous.problem.problem import Problem
from sinuous.solver.routing.bottlenecks import STRETCHED, BottleneckDecomposition
from sinuous.solver.routing.growth import LEG_POINTS
from sinuous.solver.routing.partial_problems import Groups
from tests.helpers import Floats, kernel_groups

RADIUS = 0.1
ROBOT = Robot([Segment((0.8, 1.2), 2.0, radius=RADIUS)] * 6)
TARGET = Target((0.3, 0.0, 5.0))
LINE = np.linspace((0.0, 0.0, 0.0), (0.3, 0.0, 5.0), LEG_POINTS)


def walls(first: float, last: float) -> Scene:
    """A wall from one height to another, with a channel of 1.5 radii around the line."""
    x, half = 0.03 * (first + last), 0.5 * (last - first)
    sides = ((2.0, 0.0), (-2.0, 0.0), (0.0, 2.0), (0.0, -2.0))
    size = 2.0 * (2.0 - 1.5 * RADIUS)
    boxes = [Box((x + a, b, first + half), (size if a else 0.3, size if b else 8.0, 2.0 * half)) for a, b in sides]
    return Scene(boxes)


def groups(scene: Scene) -> Groups:
    return kernel_groups(Problem(ROBOT, [TARGET], scene))


def room(first: int, last: int) -> Floats:
    room = np.full((1, LEG_POINTS), 10.0 * RADIUS)
    room[0, first : last + 1] = 1.5 * RADIUS
    return room


@pytest.mark.parametrize(("first", "last"), [(2.0, 2.2), (3.0, 3.1), (1.5, 3.0)])
def test_chains_lead_through_a_door_and_a_channel(first: float, last: float) -> None:
    scene = walls(first, last)
    along = [round(height / 5.0 * (LEG_POINTS - 1)) for height in (first, last)]
    halves = BottleneckDecomposition(groups(scene), LINE[None], room(*along))
    assert halves.any
    chains = list(halves.chains(20, lambda: 60.0))
    assert chains
    assert max(ROBOT.excess(q) for q in chains) <= 1e-9
    best = max(float(scene.distance(ROBOT.backbone(q, 60)).min()) for q in chains)
    off = min(float(np.linalg.norm(ROBOT.tip(q)[:3, 3] - LINE[-1])) for q in chains)
    assert best > 0.0  # no axis leads through a wall
    assert off < 0.5 * RADIUS


@pytest.mark.parametrize("at", [40, 80, 120])
def test_either_part_is_long_enough_and_the_first_ends_in_the_narrow_place(at: int) -> None:
    halves = BottleneckDecomposition(groups(Scene([])), LINE[None], room(at, at))
    for q in halves.chains(20, lambda: 60.0):
        ends = ROBOT.forward(q)[:, :3, 3]
        gaps = np.linalg.norm(ends - LINE[at], axis=1)
        count = 1 + int(gaps.argmin())
        assert gaps.min() < 0.3 * RADIUS
        assert 1.2 * count >= STRETCHED * np.linalg.norm(LINE[at] - LINE[0])
        assert 1.2 * (6 - count) >= STRETCHED * np.linalg.norm(LINE[-1] - LINE[at])


def test_there_is_no_place_in_the_open_nor_where_an_end_lies_in_it() -> None:
    asked = groups(Scene([]))
    assert not BottleneckDecomposition(asked, LINE[None], np.full((1, LEG_POINTS), 10.0 * RADIUS)).any
    assert not BottleneckDecomposition(asked, np.zeros_like(LINE)[None], np.full((1, LEG_POINTS), 10.0 * RADIUS)).any
    assert not BottleneckDecomposition(asked, LINE[None], np.full((1, LEG_POINTS), np.inf)).any
    assert not BottleneckDecomposition(asked, LINE[None], room(0, 30)).any
    assert not BottleneckDecomposition(asked, LINE[None], room(130, LEG_POINTS - 1)).any


def test_without_time_there_is_none() -> None:
    assert not list(BottleneckDecomposition(groups(Scene([])), LINE[None], room(60, 60)).chains(20, lambda: 0.0))
