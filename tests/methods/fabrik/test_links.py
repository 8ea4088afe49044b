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
