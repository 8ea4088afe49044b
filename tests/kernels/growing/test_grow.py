"""Chains grown along routes: limits, clearance and ends, what symmetry says of them, and a budget.

Chains turned round: the same curve, from the other end.
"""

import math

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.growing.beam import (
    CHAIN_WIDTH,
    END_DISTANCE,
    FRAME,
    LAST_SEGMENT_Q,
    PARENT,
    SEGMENT_BEFORE_Q,
    beam_size,
)
from sinuous.kernels.growing.grow import grow_chains
from sinuous.kernels.growing.turning import turn_round
from sinuous.model.robot import robot_group
from sinuous.solver.polylines import respaced
from tests.helpers import Floats, kernel_groups

RADIUS = 0.1
KEPT = 0.5
"""Deepest overlap of a chain that is kept, in radii."""

ROBOT = sn.Robot.uniform(6, length=1.0, max_bend=1.6, radius=RADIUS)
BEHIND = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.5], [0.6, 0.0, 0.5], [1.0, 0.0, 0.0], [1.2, 0.0, -2.0]])
"""A route that turns back on the spot, as no body can."""

BOXES = [
    *(sn.Box((1.2 + side * 1.2, 0.0, -0.75), (2.0, 4.0, 0.1)) for side in (-1.0, 1.0)),
    *(sn.Box((1.2, side * 1.2, -0.75), (0.4, 2.0, 0.1)) for side in (-1.0, 1.0)),
]
WALLS = sn.Scene(BOXES)
"""A wall beside the base, with a slit of 0.4."""


def grown(
    robot: sn.Robot,
    scene: sn.Scene,
    targets: list[sn.Target],
    legs: list[Floats],
    count: int = 4,
    seconds: float = 60.0,
    most: int | None = None,
    points: int = 80,
) -> Floats:
    """The best `count` chains of the most segments that there are."""
    problem = sn.Problem(robot, targets, scene)
    n, width = len(robot) if most is None else most, 8 * count
    levels = np.full((n + 1, width, CHAIN_WIDTH), np.nan)  # nothing of what was there before may matter
    workspace, counts = np.full(beam_size(len(problem.scene), width), np.nan), np.full(n + 1, -1)
    routes = np.stack([respaced(leg, points) for leg in legs])
    root = np.append(robot.base[:3, :3].ravel(), robot.base[:3, 3])
    grow_chains(*kernel_groups(problem), routes, root[None], math.inf, seconds, workspace, levels, counts)
    chains = np.empty((min(count, counts[n]), n, 3))
    for i, q in enumerate(chains):
        at = i
        for k in range(n, 0, -1):
            if k == n:
                q[k - 1] = levels[k, at, LAST_SEGMENT_Q : LAST_SEGMENT_Q + 3]
            if k > 1:
                q[k - 2] = levels[k, at, SEGMENT_BEFORE_Q : SEGMENT_BEFORE_Q + 3]
            at = int(levels[k, at, PARENT])
        assert np.allclose(levels[n, i, FRAME : FRAME + 12], _pose(robot.changed(segments=robot.segments[:n]), q, n))
    return chains


def _pose(robot: sn.Robot, q: Floats, k: int) -> Floats:
    """Pose (12,) of the end of segment `k`, counted from 1, as a row."""
    end = robot.forward(q)[k - 1]
    return np.append(end[:3, :3].ravel(), end[:3, 3])


def overlap(robot: sn.Robot, scene: sn.Scene, q: Floats) -> float:
    """Deepest overlap of the body with obstacles, in radii, by brute force."""
    return float(1.0 - scene.distance(robot.backbone(q, 100)).min() / RADIUS)


def own_gap(robot: sn.Robot, q: Floats) -> float:
    """Least distance of two places that are half a circle apart along the body, by brute force."""
    line = robot.backbone(q, 40)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    far = np.abs(along[:, None] - along) > math.pi * RADIUS
    return float(np.where(far, np.linalg.norm(line[:, None] - line, axis=-1), math.inf).min())


@pytest.mark.parametrize("direction", [None, (0.0, 0.0, -1.0)])
def test_chains_turn_back_through_a_slit_within_limits(direction: tuple[float, float, float] | None) -> None:
    target = sn.Target((1.2, 0.0, -2.0), direction=direction)
    chains = grown(ROBOT, WALLS, [target], [BEHIND])
    assert len(chains) == 4
    for q in chains:
        assert ROBOT.excess(q) <= 1e-12
        assert overlap(ROBOT, WALLS, q) <= KEPT + 0.05
        assert own_gap(ROBOT, q) > 1.8 * RADIUS
    best = ROBOT.tip(chains[0])
    assert np.linalg.norm(best[:3, 3] - (1.2, 0.0, -2.0)) < 0.5
    if direction is not None:
        assert best[:3, 2] @ np.array(direction) > 0.6


@pytest.mark.parametrize("most", [1, 4])
def test_without_a_route_chains_differ_keep_what_they_have_to_and_can_still_get_there(most: int) -> None:
    target = np.array([1.2, 0.0, -2.0])
    chains = grown(ROBOT, WALLS, [sn.Target(target)], [BEHIND], count=16, most=most, points=2)
    part = ROBOT.changed(segments=ROBOT.segments[:most])
    ends = np.stack([part.tip(q)[:3, 3] for q in chains])
    assert len(chains) == 16
    assert len(np.unique(ends.round(2), axis=0)) == 16
    assert np.linalg.norm(ends - target, axis=1).max() < 6.0 - most
    for q in chains:
        assert part.excess(q) <= 1e-12
        assert overlap(part, WALLS, q) <= KEPT + 0.05
        assert own_gap(part, q) > 1.8 * RADIUS


def test_no_chain_crosses_a_wall() -> None:
    """However thin it is: on this side of it the route is seen, but beyond it the rest cannot be."""
    wall = sn.Scene([sn.Box((0.0, 0.0, 1.5), (9.0, 9.0, 0.02))])
    through = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.0), 30)
    for q in grown(ROBOT, wall, [sn.Target((0.0, 0.0, 4.0))], [through]):
        assert ROBOT.backbone(q, 50)[:, 2].max() < 1.5


def test_a_chain_goes_from_target_to_target() -> None:
    elbow, tip = np.array([0.8, 0.0, 2.0]), np.array([3.2, 0.4, 2.8])
    legs = [np.linspace(np.zeros(3), elbow, 20), np.linspace(elbow, tip, 20)]
    targets = [sn.Target(tip), sn.Target(elbow, segment=3)]
    best = grown(ROBOT, sn.Scene([]), targets, legs)[0]
    ends = ROBOT.backbone(best, 1)
    assert np.linalg.norm(ends[3] - elbow) < 0.5
    assert np.linalg.norm(ends[6] - tip) < 0.5


def test_without_time_there_is_none() -> None:
    assert len(grown(ROBOT, WALLS, [sn.Target(BEHIND[-1])], [BEHIND], seconds=0.0)) == 0


def test_chains_stop_in_the_open() -> None:
    """Out of a straight channel, two segments and a half long: the third segment ends beyond it."""
    walls = [
        sn.Box((x, y, 1.2), (0.2 if x else 1.0, 0.2 if y else 1.0, 2.6))
        for x, y in ((0.3, 0.0), (-0.3, 0.0), (0.0, 0.3), (0.0, -0.3))
    ]
    goal = np.array([3.0, 0.0, 4.0])
    problem = sn.Problem(ROBOT, [sn.Target(goal)], sn.Scene(walls))
    points = respaced(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.8], goal]), 80)[None]
    root = np.append(np.eye(3).ravel(), np.zeros(3))[None]
    levels, counts = np.zeros((7, 8, CHAIN_WIDTH)), np.zeros(7, np.int64)
    workspace = np.empty(beam_size(4, 8))
    assert grow_chains(*kernel_groups(problem), points, root, 3.5, 60.0, workspace, levels, counts)
    assert (counts[:4] > 0).all()
    assert (counts[4:] == 0).all()
    room = [problem.scene.distance(levels[k, : counts[k], FRAME + 9 : FRAME + 12]) / RADIUS for k in range(4)]
    assert max(max(own) for own in room[:3]) < 3.5 <= max(room[3])
    np.testing.assert_allclose(
        np.minimum(levels[3, : counts[3], END_DISTANCE], 3.5), np.minimum(room[3], 3.5), rtol=1e-6
    )


@pytest.mark.parametrize("seed", range(4))
def test_a_chain_and_the_one_turned_round_are_one_curve(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 1 + 2 * seed
    segments = [sn.Segment((0.5, 2.0), 4.0)] * n
    robot = sn.Robot(segments, base=sn.pose(rng.normal(size=3), rotation=rng.normal(size=4)))
    q = np.column_stack([rng.uniform(-1.5, 1.5, (n, 2)), rng.uniform(0.5, 2.0, n)])
    tip = robot.tip(q)
    flip = np.diag([1.0, -1.0, -1.0, 1.0])
    roll = sn.pose(rotation=(np.cos(0.4), 0.0, 0.0, np.sin(0.4)))  # nothing may hang on the angle that it begins with
    other = sn.Robot(segments, base=tip @ roll @ flip)
    back, there = np.empty((n, 3)), np.empty((n, 3))
    groups = robot_group(robot), robot_group(other)
    # From the robot's own chain to that of the turned one, and back.
    turn_round(groups[1], groups[0], q, back)
    assert np.allclose(robot.backbone(q, 5), other.backbone(back, 5)[::-1])
    turn_round(*groups, back, there)
    assert np.allclose(there, q)
