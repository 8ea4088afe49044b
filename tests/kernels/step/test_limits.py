"""The limits of a segment are held exactly, and a bound step runs along them."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sinuous as sn
from sinuous.kernels.step import limits
from tests.helpers import BENDS, Floats

SEGMENTS = (
    sn.Segment((0.5, 2.0), 2.0),
    sn.Segment((0.5, 2.0), 2.0, max_curvature=1.5),
    sn.Segment((0.0, 2.0), 6.0, max_curvature=0.7),
    sn.Segment(1.0, 1.0),
    sn.Segment((0.5, 1.0), 0.0),
    sn.Segment(0.0, 1.0),
)
TABLE = sn.Robot(SEGMENTS).limits
ONES = st.integers(0, len(SEGMENTS) - 1)
bends = st.one_of(st.sampled_from(BENDS), st.floats(0.0, 10.0))
angles = st.floats(-math.pi, math.pi)
lengths = st.floats(-3.0, 5.0)


def cap(k: int, length: float) -> float:
    """The largest bend of this segment, from what was asked of it."""
    segment = SEGMENTS[k]
    if segment.length[1] == 0.0:
        return 0.0
    return min(segment.max_bend, segment.max_curvature * length)


def excess(k: int, q: Any) -> float:
    low, high = SEGMENTS[k].length
    return float(max(low - q[2], q[2] - high, math.hypot(q[0], q[1]) - cap(k, q[2])))


@given(ONES, bends, angles, lengths)
def test_retract_ends_within_the_limits_and_stays(k: int, bend: float, angle: float, length: float) -> None:
    q = (bend * math.cos(angle), bend * math.sin(angle), length)
    once = limits.project_segment(TABLE, k, *q)
    assert excess(k, once) <= 1e-12
    assert once[2] == min(max(length, SEGMENTS[k].length[0]), SEGMENTS[k].length[1])
    assert abs(once[0] * q[1] - once[1] * q[0]) <= 1e-12 * (1.0 + bend) ** 2  # the direction of the bend is kept
    np.testing.assert_allclose(limits.project_segment(TABLE, k, *once), once, rtol=0, atol=1e-12)


def within(rng: np.random.Generator) -> Floats:
    """Draw a configuration within the limits, often on them."""
    out = []
    for k, segment in enumerate(SEGMENTS):
        low, high = segment.length
        length = rng.choice([low, high, rng.uniform(low, high)])
        bend = rng.choice([0.0, 1.0, rng.random()]) * cap(k, length)
        angle = rng.uniform(-math.pi, math.pi)
        out.append(limits.project_segment(TABLE, k, bend * math.cos(angle), bend * math.sin(angle), length))
    return np.array(out)


def workspace() -> tuple[Floats, Floats, Any]:
    n = len(SEGMENTS)
    root, mean, bound = np.full((n, 9), np.nan), np.zeros((n, 3)), np.full(n, 9, np.int64)
    limits.release(TABLE, root, mean, bound)
    return root, mean, bound


@pytest.mark.parametrize("wished", [0.0, 1.0])
@pytest.mark.parametrize("seed", range(10))
def test_a_bound_segment_goes_to_its_bound_and_does_what_it_wishes_along_it(seed: int, wished: float) -> None:
    """What is left of the wish is across what the segment can still do, in the metric of its scales."""
    rng = np.random.default_rng(seed)
    q, step = within(rng), rng.normal(size=(len(SEGMENTS), 3)) * rng.choice([0.1, 1.0, 10.0])
    free, _, _ = workspace()
    root, mean, bound = workspace()
    wish = wished * rng.normal(size=mean.shape) * (np.diagonal(free.reshape(-1, 3, 3), axis1=1, axis2=2) > 0.0)
    mean[:] = wish
    count = limits.bind(TABLE, q, step, root, mean, bound)
    assert count == np.count_nonzero(bound)
    for k in range(len(SEGMENTS)):
        aim = q[k] + step[k]
        low, high = SEGMENTS[k].length
        assert bool(bound[k]) == (excess(k, aim) > 1e-9)
        D, L = np.linalg.pinv(free[k].reshape(3, 3)), root[k].reshape(3, 3)
        np.testing.assert_allclose((D @ L).T @ D @ (wish[k] - mean[k]), 0.0, atol=1e-9)
        if not bound[k]:
            np.testing.assert_array_equal(L, free[k].reshape(3, 3))
            np.testing.assert_array_equal(mean[k], wish[k])
            continue
        assert bool(bound[k] & 1) == (not low <= aim[2] <= high)
        normal = aim[:2] / np.hypot(*aim[:2])
        moves = [mean[k] + L @ z for z in 3.0 * rng.normal(size=(5, 3))]
        for move in moves:
            end = q[k] + move
            if bound[k] & 1:
                assert end[2] == pytest.approx(min(max(aim[2], low), high), abs=1e-12)
            if bound[k] & 2:
                edge = cap(k, min(max(aim[2], low), high))
                if edge < SEGMENTS[k].max_bend and L[2].any():
                    edge = SEGMENTS[k].max_curvature * end[2]  # free to slide along the slanted edge
                assert normal @ end[:2] == pytest.approx(edge, abs=1e-9)
        # What is left is everything the scales allow, less one direction a bound.
        free_rank = np.linalg.matrix_rank(free[k].reshape(3, 3))
        lengthless = free[k].reshape(3, 3)[2, 2] == 0.0
        lost = int(bool(bound[k] & 1) and not lengthless) + int(bool(bound[k] & 2) and free_rank > 1)
        assert np.linalg.matrix_rank(L, tol=1e-12) == max(0, free_rank - lost)
