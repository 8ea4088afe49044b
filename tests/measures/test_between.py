"""The way between knots, looked at densely, held against the slow path at rest.

The sampled self-clearance, against all pairs of places, and on shapes that can be worked out by hand.

How far a body is off a curve, held against the other kinematics.
"""

import math

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures import body
from sinuous.measures.body import Meeting, body_places, least_clearance, least_self_clearance, segment_ends
from sinuous.measures.following import (
    FEWEST,
    MOST,
    PLACES,
    STRIDE,
    deviation,
    least_clearances,
    least_meeting,
    shares_between,
)
from sinuous.measures.following import body_places as places_of
from sinuous.scene.scene import as_snapshot
from tests.helpers import Floats, present
from tests.kernels.body.test_self_proof import curled, sampled

ARM = sn.Robot.uniform(3, (0.5, 1.5), 6.0, radius=0.05, base=sn.pose((1, 2, 3), direction=(1, 1, 0)))


def test_clearances_are_those_of_single_shapes() -> None:
    rng = np.random.default_rng(0)
    q = np.concatenate([rng.uniform(-2, 2, (5, 3, 2)), rng.uniform(0.5, 1.5, (5, 3, 1))], axis=-1)
    mounted = ARM.changed(mount=0.8)
    scene = as_snapshot([sn.Sphere((2, 2, 3), 0.4, name="ball"), sn.Box((1, 3, 3.5), (0.2, 0.3, 0.4), name="box")])
    least, _, segments, obstacles = least_clearances(mounted, scene, q)
    for i, one in enumerate(q):
        ends = segment_ends(mounted, one)
        alone = least_clearance(mounted, scene, one, ends)
        assert least[i] == pytest.approx(alone.distance, abs=2e-3)
        assert (segments[i] + 1, scene.name(int(obstacles[i]))) == (alone.segment, alone.obstacle)
        assert least_meeting(mounted, one[None]).gap == pytest.approx(
            least_self_clearance(mounted, one, ends).gap, abs=5e-3
        )


def test_between_two_looks_no_place_moves_far() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        one, other = (
            np.concatenate([rng.uniform(-1, 1, (3, 2)), rng.uniform(0.5, 1.5, (3, 1))], axis=-1) for _ in range(2)
        )
        shares = shares_between(ARM, one, other)
        assert FEWEST < len(shares) <= MOST + 1
        q = one + shares[:, None, None] * (other - one)
        moved = np.linalg.norm(np.diff(ARM.backbone(q, 8), axis=0), axis=-1).max()
        assert moved <= STRIDE * np.maximum(one, other)[:, 2].sum() * (1.0 + 1e-12)


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_where_the_body_leaves_its_mount_it_is_looked_at(unit: float) -> None:
    """A needle just there meets none of the even samples, and what is within the mount counts for nothing."""
    robot = sn.Robot([sn.Segment(unit, 0.0)], mount=unit / 3.0)
    place, q = unit / 3.0, np.array([[0.0, 0.0, unit]])
    below = as_snapshot([sn.Sphere((0, 0, place - 1e-3 * unit), 5e-4 * unit)])
    for found in (
        least_clearance(robot, below, q, segment_ends(robot, q)).distance,
        least_clearances(robot, below, q[None])[0][0],
    ):
        assert found == pytest.approx(5e-4 * unit, rel=1e-9)


def test_a_joint_at_which_the_mount_ends_counts_for_what_is_beyond_it() -> None:
    robot = sn.Robot([sn.Segment(0.1, 0.0, radius=0.2), sn.Segment(1.0, 1.0, radius=0.01)], mount=0.1)
    q, scene = np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 1.0]]), as_snapshot([sn.Sphere((0.1, 0, 0.1), 0.05)])
    assert least_clearance(robot, scene, q, segment_ends(robot, q)).distance == pytest.approx(0.04)
    assert least_clearances(robot, scene, q[None])[0][0] == pytest.approx(0.04)
    solution = sn.solve(robot, sn.Target((0.0, 0.0, 1.1)), scene.obstacles)
    assert solution.solved
    assert solution.verify().ok


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
    assert present(segments)[1] == 3
    assert place is not None
    assert place.segment == 3
    cut = np.concatenate([tighter[:2], tighter[2:] * present(place.share)])
    assert place.position == pytest.approx(robot.forward(cut)[-1, :3, 3], abs=1e-9)


def test_the_end_of_a_thick_part_is_no_obstacle_to_what_leads_on_but_to_what_comes_back() -> None:
    robot = sn.Robot([sn.Segment((0.01, 1.0), 3.2, radius=radius) for radius in (0.1, 0.01, 0.01)])
    for bend, clear in ((0.0, True), (1.5, True), (math.pi, False)):
        q = np.array([[0.0, 0.0, 0.5], [bend, 0.0, 0.05], [0.0, 0.0, 0.2]])
        assert (measured(robot, q).gap > 0.0) == clear


BARE = sn.Robot.uniform(3, (0.5, 1.5), base=sn.pose((1, 2, 3), direction=(1, 1, 0)))


def test_places_are_those_of_matrix_exponentials() -> None:
    rng = np.random.default_rng(0)
    q = np.concatenate([rng.uniform(-2, 2, (4, 3, 2)), rng.uniform(0.5, 1.5, (4, 3, 1))], axis=-1)
    q[0, 1, :2] = 0.0, 1e-9
    found = places_of(BARE, q)
    for i, one in enumerate(q):
        every = body_places(BARE, one, segment_ends(BARE, one))[0].reshape(3, -1, 3)
        np.testing.assert_allclose(found[i], every[:, :: 200 // PLACES], atol=1e-9)


def test_a_parallel_line_is_as_far_everywhere() -> None:
    stage = sn.Robot([sn.Segment(5.0, max_bend=0.0), *sn.Robot.uniform(2, 1.0).segments])
    q = np.array([[[0, 0, 5.0], [0, 0, 1], [0, 0, 1]]])
    found = deviation(stage, q, sn.Curve([(0.1, 0, -1), (0.1, 0, 9)]))
    assert found.length == 2.0
    assert found.shape == pytest.approx(0.1)
    assert found.shares == pytest.approx(dict.fromkeys(("tip", "tip_mean", "shape", "shape_mean"), 0.05))
    assert repr(found) == "Deviation(tip 5 %, mean 5 %, shape 5 %, mean 5 %)"


@pytest.mark.parametrize("radius", [0.02, 0.1])
def test_many_shapes_are_as_near_to_themselves_as_the_nearest_of_them(
    radius: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where few places are looked at together, and each time only for what is nearer than was seen before."""
    robot, rng = sn.Robot([sn.Segment((0.0, 2.0), 6.0, radius=radius)] * 4), np.random.default_rng(4)
    q = np.stack([curled(rng, [radius] * 4, 2.5) for _ in range(8)])
    alone = [least_meeting(robot, one[None]) for one in q]
    monkeypatch.setattr(body, "PAIRS", 1)
    assert least_meeting(robot, q) == min(alone, key=lambda each: each.gap)
