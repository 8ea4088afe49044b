"""The sampled self-clearance, against all pairs of places, and on shapes that can be worked out by hand."""

import math

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.body import Meeting, least_self_clearance, segment_ends
from tests.helpers import Floats
from tests.kernels.body.test_self_proof import curled, sampled


def measured(robot: sn.Robot, q: Floats) -> Meeting:
    return least_self_clearance(robot, q, segment_ends(robot, q))


@pytest.mark.parametrize("several", [False, True])
@pytest.mark.parametrize("thick", [(0.02, 0.2), (0.3, 0.9)])
def test_it_is_the_least_of_all_pairs(several: bool, thick: tuple[float, float]) -> None:
    rng = np.random.default_rng(2)
    for _ in range(8):
        radii = rng.uniform(*thick, 4) if several else np.full(4, rng.uniform(*thick))
        q = curled(rng, radii, 2.5)
        robot = sn.Robot([sn.Segment((0.0, 2.0), 6.0, radius=radius) for radius in radii])
        least, spacing = sampled(q, list(radii))
        found = measured(robot, q)
        if math.isinf(least) or math.isinf(found.gap):
            assert q[:, 2].sum() < math.pi * radii.max() + 1e-9 if not several else found.gap == least
            continue
        assert found.gap == pytest.approx(least, abs=2.0 * spacing)


def test_a_hairpin_touches_itself_where_it_says() -> None:
    robot = sn.Robot.uniform(3, (0.1, 2.0), 4.0, radius=0.2)
    q = np.array([[0.0, 0.0, 1.0], [math.pi, 0.0, 0.35 * math.pi], [0.0, 0.0, 1.0]])
    gap = measured(robot, q).gap
    # Places half a circle of the body apart along the bend are nearer to each other than the legs.
    assert gap == pytest.approx(0.7 * math.sin(0.2 * math.pi / 0.7) - 0.4, abs=0.005)
    tighter = q.copy()
    tighter[1, 2] = 0.21 * math.pi
    tighter[2, 0] = 0.6
    gap, segments, place = measured(robot, tighter)
    assert gap < 0.0
    assert segments is not None
    assert segments[1] == 3
    assert place is not None
    assert place.segment == 3
    assert place.share is not None
    cut = np.concatenate([tighter[:2], tighter[2:] * place.share])
    assert place.position == pytest.approx(robot.forward(cut)[-1, :3, 3], abs=1e-9)


def test_the_end_of_a_thick_part_is_no_obstacle_to_what_leads_on_but_to_what_comes_back() -> None:
    robot = sn.Robot([sn.Segment((0.01, 1.0), 3.2, radius=radius) for radius in (0.1, 0.01, 0.01)])
    for bend, clear in ((0.0, True), (1.5, True), (math.pi, False)):
        q = np.array([[0.0, 0.0, 0.5], [bend, 0.0, 0.05], [0.0, 0.0, 0.2]])
        assert (measured(robot, q).gap > 0.0) == clear
