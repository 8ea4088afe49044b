"""Links of a section, and the passes over them: where tangents meet, cones, limits, fixed points."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.methods.fabrik import links as fabrik
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from tests.cases import with_each
from tests.helpers import Floats, expm_chain, vec

MIXED = Robot(
    [
        Segment((0.5, 2.0), 2.0),
        Segment((0.5, 2.0), 3.0, max_curvature=1.5),
        Segment((0.2, 1.0), 1.0),
        Segment(1.0, 0.0),
        Segment(0.7, math.pi),
    ]
)


def make_chain(segments: int, pieces: int = 1, taper: float = 0.0, lengths: Any = 1.0) -> Any:
    """Give a chain of its own memory, of sections that cannot stretch."""
    m = -(-segments // pieces)
    chain = fabrik.Chain(
        np.zeros(m + 1, np.int64),
        np.zeros(segments),
        np.zeros(segments),
        np.zeros((m + 1, 3)),
        np.zeros((m, 3)),
        np.zeros((m + 1, 3)),
        np.zeros(m),
        np.zeros(m),
        np.zeros(m),
        np.zeros(m),
    )
    fabrik.group(chain, segments, pieces, taper)
    own = np.broadcast_to(np.asarray(lengths, np.float64), (segments,))
    for i in range(m):
        rows = slice(chain.first[i], chain.first[i + 1])
        chain.part[rows] = own[rows] / own[rows].sum()
        chain.lengths[i] = chain.low[i] = chain.high[i] = own[rows].sum()
    return chain


def section(chain: Any, i: int, bend: float, length: float) -> Floats:
    """Give the segments of section i at this bend, in the plane of x and z."""
    rows = slice(chain.first[i], chain.first[i + 1])
    return np.stack([bend * chain.share[rows], 0.0 * chain.share[rows], length * chain.part[rows]], axis=-1)


def test_groups_take_all_segments_in_order_and_share_the_whole_bend() -> None:
    for segments, pieces in ((1, 1), (5, 1), (5, 2), (6, 3), (3, 7)):
        for taper in (0.0, 0.6, -0.9):
            chain = make_chain(segments, pieces, taper)
            assert chain.first[0] == 0
            assert chain.first[-1] == segments
            sizes = np.diff(chain.first)
            assert (sizes[:-1] == pieces).all()
            assert 1 <= sizes[-1] <= pieces
            np.testing.assert_allclose(np.add.reduceat(chain.share, chain.first[:-1]), 1.0, rtol=1e-14)
            assert (chain.share > 0.0).all()


def test_a_taper_moves_the_bend_towards_the_tip() -> None:
    np.testing.assert_allclose(make_chain(2, 2, 0.5).share, [0.375, 0.625])


@with_each("bend", [0.0, 1e-9, 1e-5, 1e-3, 0.3, 1.5, 2.9])
def test_the_links_of_an_arc(bend: float) -> None:
    near, far = fabrik.links(make_chain(1), 0, bend)
    assert near == far
    assert near == pytest.approx(0.5 if bend == 0.0 else math.tan(0.5 * bend) / bend, rel=1e-10)


@with_each("pieces", [1, 2, 3, 5])
@with_each("bend", [0.0, 1e-7, 1e-3, 0.4, 1.7, 2.9])
def test_the_tangents_at_the_ends_meet_in_the_joint(pieces: int, bend: float) -> None:
    rng = np.random.default_rng(pieces)
    for taper in (0.0, 0.8, -0.5):
        chain = make_chain(pieces, pieces, taper, rng.uniform(0.3, 2.0, pieces))
        near, far = fabrik.links(chain, 0, bend)
        end = expm_chain(section(chain, 0, bend, 3.0))[-1]
        joint = np.array([0.0, 0.0, 3.0 * near])
        np.testing.assert_allclose(end[:3, 3] - 3.0 * far * end[:3, 2], joint, atol=1e-9)


def test_the_links_of_a_tapered_section_differ() -> None:
    near, far = fabrik.links(make_chain(4, 4, 0.9), 0, 1.5)
    assert near > 1.05 * far


def test_a_cone_keeps_what_is_in_it_and_brings_the_rest_to_its_edge() -> None:
    rng = np.random.default_rng(0)
    for _ in range(200):
        axis, wanted = (x / np.linalg.norm(x) for x in rng.normal(size=(2, 3)))
        cap = rng.choice([0.0, 0.3, 1.5, 2.8])
        apart = math.acos(np.clip(axis @ wanted, -1.0, 1.0))
        found, angle = fabrik.cone(vec(axis), vec(wanted), cap)
        assert np.linalg.norm(found) == pytest.approx(1.0)
        assert angle == pytest.approx(min(apart, cap), abs=1e-7)
        assert math.acos(np.clip(axis @ found, -1.0, 1.0)) == pytest.approx(angle, abs=1e-7)
        # Nothing in the cone is closer: the angles of a triangle that has no height add up.
        assert math.acos(np.clip(wanted @ found, -1.0, 1.0)) == pytest.approx(max(0.0, apart - cap), abs=1e-7)


def test_a_cone_opposite_to_its_axis_still_has_an_edge() -> None:
    found, angle = fabrik.cone((0.0, 0.0, 1.0), (0.0, 0.0, -1.0), 1.0)
    assert angle == 1.0
    assert found[2] == pytest.approx(math.cos(1.0))
    assert np.linalg.norm(found) == pytest.approx(1.0)


def test_the_cap_of_a_section_is_that_of_its_tightest_segment() -> None:
    chain = make_chain(5)
    assert fabrik.cap_of(chain, MIXED.limits, 0, 2.0) == 2.0
    assert fabrik.cap_of(chain, MIXED.limits, 1, 1.0) == 1.5
    assert fabrik.cap_of(chain, MIXED.limits, 3, 1.0) == 0.0
    assert fabrik.cap_of(chain, MIXED.limits, 4, 0.7) == fabrik.STEEPEST
    pair = make_chain(2, 2, 0.0, (1.0, 3.0))
    assert fabrik.cap_of(pair, MIXED.limits, 0, 4.0) == fabrik.STEEPEST  # 2.0 / 0.5 would be more
    assert fabrik.cap_of(pair, MIXED.limits[1:3].copy(), 0, 4.0) == 2.0


def lay_out(chain: Any, limits: Floats, goal: Floats, aim: Floats | None) -> Floats:
    """Reach back and out once, and return the tip."""
    toward = vec([0.0, 0.0, 0.0] if aim is None else aim)
    fabrik.reach_back(chain, limits, vec(goal), toward, aim is not None)
    fabrik.reach_out(chain, limits, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), toward, aim is not None)
    return np.array(chain.points[-1])


def start(chain: Any, stretch: bool, limits: Floats = MIXED.limits) -> None:
    """Straight up, with mean lengths."""
    at = 0.0
    for i in range(len(chain.bends)):
        low, high = limits[i, :2]
        chain.lengths[i] = 0.5 * (low + high)
        chain.low[i], chain.high[i] = (low, high) if stretch else (chain.lengths[i],) * 2
        chain.joints[i] = 0.0, 0.0, at + 0.5 * chain.lengths[i]
        chain.tangents[i + 1] = 0.0, 0.0, 1.0
        chain.bends[i] = 0.0
        at += chain.lengths[i]
        chain.points[i + 1] = 0.0, 0.0, at


@with_each("stretch", [False, True])
@with_each("seed", range(10))
def test_every_pass_keeps_the_limits_and_the_links_together(seed: int, stretch: bool) -> None:
    rng = np.random.default_rng(seed)
    chain = make_chain(5)
    start(chain, stretch)
    goal = rng.normal(size=3) * rng.choice([0.1, 2.0, 20.0])
    aim = rng.normal(size=3)
    for _ in range(5):
        lay_out(chain, MIXED.limits, goal, aim / np.linalg.norm(aim) if seed % 2 else None)
        at, tangents = np.zeros(3), chain.tangents
        np.testing.assert_array_equal(chain.points[0], at)
        np.testing.assert_allclose(np.linalg.norm(tangents, axis=1), 1.0, rtol=1e-12)
        np.testing.assert_array_equal(tangents[0], [0.0, 0.0, 1.0])
        for i in range(5):
            assert chain.low[i] <= chain.lengths[i] <= chain.high[i]
            assert chain.bends[i] <= fabrik.cap_of(chain, MIXED.limits, i, chain.lengths[i]) + 1e-12
            apart = np.arctan2(np.linalg.norm(np.cross(*tangents[i : i + 2])), tangents[i] @ tangents[i + 1])
            assert apart == pytest.approx(chain.bends[i], abs=1e-9)
            near, far = fabrik.links(chain, i, chain.bends[i])
            np.testing.assert_allclose(at + near * chain.lengths[i] * tangents[i], chain.joints[i], atol=1e-9)
            at = chain.points[i + 1]
            np.testing.assert_allclose(chain.joints[i] + far * chain.lengths[i] * tangents[i + 1], at, atol=1e-9)


@pytest.mark.parametrize("stretch", [False, True])
def test_a_chain_at_its_target_stays_as_it_is(stretch: bool) -> None:
    limits = Robot.uniform(5, (0.5, 1.5), 2.0).limits
    chain = make_chain(5)
    start(chain, stretch, limits)
    goal, aim = np.array([1.0, 0.7, 3.5]), np.array([0.6, 0.0, 0.8])
    for _ in range(400):
        tip = lay_out(chain, limits, goal, aim)
    np.testing.assert_allclose(tip, goal, atol=1e-9)
    np.testing.assert_allclose(chain.tangents[-1], aim, atol=1e-12)
    before = chain.joints.copy()
    lay_out(chain, limits, goal, aim)
    np.testing.assert_allclose(chain.joints, before, atol=1e-8)


def test_stretching_reaches_what_fixed_lengths_cannot() -> None:
    far_away = np.array([0.0, 0.3, 6.0])  # 6.7 at most, 4.8 at the mean lengths
    misses = []
    for stretch in (False, True):
        chain = make_chain(5)
        start(chain, stretch)
        for _ in range(100):
            tip = lay_out(chain, MIXED.limits, far_away, None)
        misses.append(np.linalg.norm(tip - far_away))
    assert misses[0] > 1.0
    assert misses[1] < 1e-3
