"""Self-collision: what sampling sees is what brute force sees, and laws of the thickness of a tube."""

import math

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.kinematics import body_points
from benchmarks.judges.self_collision import FINEST, look, surely_clear
from benchmarks.problems import random_configurations
from sinuous.base.checks import Floats


def brute(robot: sn.Robot, q: Floats, samples: int) -> float:
    """Least gap of all pairs of evenly spaced places of one configuration (n, 3)."""
    points, along = body_points(robot, q[None], samples)
    radii = np.repeat(robot.radii, samples + 1)
    flat, place = points.reshape(-1, 3), along.ravel()
    gaps = np.linalg.norm(flat[:, None] - flat, axis=-1) - radii[:, None] - radii
    counted = np.abs(place[:, None] - place) >= math.pi * np.maximum(radii[:, None], radii)
    return float(np.where(counted, gaps, math.inf).min())


@pytest.mark.parametrize(("radii", "seed"), [((0.1,) * 4, 0), ((0.03,) * 4, 1), ((0.15, 0.05, 0.1, 0.05), 2)])
def test_it_sees_what_brute_force_sees(radii: tuple[float, ...], seed: int) -> None:
    robot = sn.Robot([sn.Segment((0.9, 1.1), 5.0, radius=radius) for radius in radii])
    q = random_configurations(robot, 30, np.random.default_rng(seed))
    samples = 60
    expected = np.array([brute(robot, one, samples) for one in q])
    seen = look(robot, q, 0.0)
    # Places that are sampled here are at most half a spacing from those sampled there, on either side.
    near = np.abs(expected) < 1.1 / samples
    assert ((seen.least < 0.0) == (expected < 0.0))[~near].all()
    assert 3 < (expected < 0.0).sum() < 27
    clear = surely_clear(robot, q)
    assert (expected[clear] > 0.0).all()
    assert not clear[seen.least < 0.0].any()
    assert clear[expected > 2.2 / samples].all()


@pytest.mark.parametrize("share", [0.9, 0.999])
def test_a_circle_that_closes_touches_itself_when_its_ends_come_near(share: float) -> None:
    """The ends of an arc that turns by t are `2 R sin(t / 2)` apart."""
    turn, radius = 2.0 * math.pi * share, 0.05
    robot = sn.Robot.uniform(1, 1.0, 7.0, radius=radius)
    q = np.array([[[turn, 0.0, 1.0]]])
    gap = 2.0 / turn * math.sin(0.5 * turn) - 2.0 * radius
    assert look(robot, q).least[0] == pytest.approx(gap, abs=FINEST * radius)
    assert surely_clear(robot, q)[0] == (gap > 0.0)
