"""The judge of self-collision, against shapes whose distance from themselves is known."""

import math

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.folds import SAMPLES, least_self_clearance
from benchmarks.judges.kinematics import body_points
from benchmarks.problems import random_configurations
from tests.self_gaps import gaps_of, sample_body


def hairpin(width: float, radius: float) -> tuple[sn.Robot, np.ndarray]:
    """Two straight pieces side by side, `width` apart, joined by half a circle."""
    q = np.array([[0.0, 0.0, 1.0], [math.pi, 0.0, 0.5 * math.pi * width], [0.0, 0.0, 1.0]])
    return sn.Robot.uniform(3, (0.0, 1.0), math.pi, radius=radius), q


@pytest.mark.parametrize("width", [0.19, 0.2, 0.25, 0.4])
def test_a_hairpin_is_as_far_from_itself_as_it_is_wide(width: float) -> None:
    """A wide one is nearest where places begin to count: a chord of the half circle over an arc of pi radii."""
    robot, q = hairpin(width, 0.1)
    nearest = width * math.sin(min(math.pi * 0.1 / width, 0.5 * math.pi))
    assert least_self_clearance(robot, q[None])[0] == pytest.approx(nearest - 0.2, abs=2e-3)


def test_no_pair_of_places_is_left_out() -> None:
    """All pairs of all places, by brute force."""
    rng = np.random.default_rng(4)
    for n, radius in ((1, 0.3), (3, 0.02), (8, 0.1), (20, 0.05)):
        robot = sn.Robot([sn.Segment((0.6, 1.0), 2.4, radius=radius)] * n, base=sn.pose((7, 8, 9)))
        q = random_configurations(robot, 5, rng)
        points, along = body_points(robot, q, SAMPLES)
        radii = np.repeat(robot.radii, SAMPLES + 1)
        for p, s, found in zip(points, along, least_self_clearance(robot, q), strict=True):
            flat = p.reshape(-1, 3)
            gaps = np.linalg.norm(flat[:, None] - flat, axis=-1) - radii[:, None] - radii
            counts = np.abs(s.ravel()[:, None] - s.ravel()) >= math.pi * np.maximum(radii[:, None], radii)
            assert found == pytest.approx(gaps.min(initial=math.inf, where=counts), abs=1e-12)


def test_of_several_radii_what_lies_ahead_does_not_count() -> None:
    """By brute force, with the true tangents: the judge leaves out what it cannot tell, and nothing else."""
    rng = np.random.default_rng(5)
    for n, radius in ((3, 0.02), (6, 0.1)):
        radii = np.linspace(radius, 0.6 * radius, n)
        robot = sn.Robot([sn.Segment((0.6, 1.0), 2.4, radius=r) for r in radii])
        q = random_configurations(robot, 5, rng)
        for one, found in zip(q, least_self_clearance(robot, q), strict=True):
            expected = float(gaps_of(sample_body(one, radii, SAMPLES)).min())
            assert expected - 1e-12 <= found <= expected + 0.05
