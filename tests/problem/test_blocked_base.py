"""A blocked base is a proof: it holds whatever the configuration."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.problem.problem import base_blocked, bound_sway

UNEVEN = [sn.Segment(0.02, 1.5, radius=0.01), sn.Segment(0.5, 0.0, radius=0.01), sn.Segment(0.3, 2.0, radius=0.01)]


def test_a_short_segment_that_turns_at_once_leads_past_what_stands_before_the_mount() -> None:
    robot = sn.Robot(UNEVEN, mount=0.3)
    scene = sn.Scene([sn.Sphere((0, 0, 0.3), 0.25)])
    past = np.array([[1.5, 0.0, 0.02], [0.0, 0.0, 0.5], [0.0, 0.0, 0.3]])
    assert not base_blocked(robot, scene.snapshot())
    solution = sn.solve(robot, sn.Target(robot.tip(past)[:3, 3]), scene, initial=past)
    assert solution.solved
    assert solution.clearance is not None
    assert solution.clearance > 0.1


@pytest.mark.parametrize("seed", range(20))
def test_no_configuration_leaves_the_mount_farther_aside_than_the_bound(seed: int) -> None:
    draw = np.random.default_rng(seed)
    n = int(draw.integers(1, 6))
    low = draw.uniform(0.02, 1.0, n) * (draw.random(n) < 0.8)
    high = low + draw.uniform(0.01, 0.5, n)
    curvatures = np.where(draw.random(n) < 0.5, draw.uniform(0.5, 6.0, n), np.inf)
    bends = draw.uniform(0.0, 3.0, n)
    mount = float(draw.uniform(0.1, 1.0) * (low.sum() + 0.05))
    begins = np.concatenate([[0.0], np.cumsum(low)[:-1]])
    ramps = [
        (begin, min(curvature, bend / least if least else np.inf), min(bend, curvature * most, np.pi))
        for begin, curvature, bend, least, most in zip(begins, curvatures, bends, low, high, strict=True)
    ]
    bound, far = bound_sway(mount, ramps), 0.0
    robot = sn.Robot([sn.Segment((a, b), c) for a, b, c in zip(low, high, bends, strict=True)])
    for _ in range(150):
        lengths = np.where(draw.random(n) < 0.6, low, draw.uniform(low, high))
        size = np.minimum(bends, curvatures * np.maximum(lengths, 1e-300)) * np.where(
            draw.random(n) < 0.7, 1.0, draw.random(n)
        )
        turn = draw.uniform(0.0, 2 * np.pi) * np.ones(n) if draw.random() < 0.7 else draw.uniform(0.0, 2 * np.pi, n)
        q = np.stack([size * np.cos(turn), size * np.sin(turn), lengths], axis=1)
        if lengths.sum() <= mount:
            continue
        k = int(np.searchsorted(np.cumsum(lengths), mount))
        share = (mount - lengths[:k].sum()) / lengths[k]
        q[k] *= share
        end = robot.forward(q)[k, :3, 3]
        far = max(far, float(np.linalg.norm(end - (0.0, 0.0, mount))))
    assert far <= bound * (1.0 + 1e-9) + 1e-12


def test_an_evenly_bent_mount_is_bounded_as_closely_as_by_its_arc() -> None:
    arc = sn.Robot([sn.Segment(1.0, 0.4)]).forward(np.array([[0.4, 0.0, 1.0]]))[0, :3, 3]
    aside = float(np.linalg.norm(arc - (0.0, 0.0, 1.0)))
    assert aside <= bound_sway(1.0, [(0.0, 0.4, 0.4)]) <= 1.02 * aside
    assert bound_sway(1.0, [(0.0, 0.0, 0.0)]) == 0.0


def test_a_base_within_an_obstacle_stays_blocked() -> None:
    robot = sn.Robot.uniform(3, 1.0, 1.0, radius=0.1, mount=0.2, base=sn.pose((5.0, 0.0, 0.0)))
    assert base_blocked(robot, sn.Scene([sn.Sphere((5, 0, 0.2), 0.5)]).snapshot())
    assert not base_blocked(robot, sn.Scene([sn.Sphere((5, 0, 3), 0.5)]).snapshot())
