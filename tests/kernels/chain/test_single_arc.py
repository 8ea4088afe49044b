"""The single arc to a point: by the matrix exponential, and by what bounds it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from sinuous.kernels.chain.single_arc import MOST_HALF_BEND, STRAIGHT, arc_length, arc_to
from tests.cases import with_each
from tests.helpers import BENDS, twist_matrix

ARCS = [bend for bend in BENDS if bend < 2.0 * MOST_HALF_BEND]


@with_each("bend", ARCS)
@with_each("length", [1e-3, 1.0, 60.0])
def test_an_arc_is_found_again_from_its_end(bend: float, length: float) -> None:
    end = expm(twist_matrix(np.array([bend, 0.0, length])))[:3, 3]
    half, found = arc_to(math.hypot(end[0], end[1]), end[2])
    # Near a whole turn the chord is a small difference of large numbers.
    loss = 1.0 / max(1e-9, math.sin(0.5 * bend) / max(0.5 * bend, 1e-300)) if bend > 1e-8 else 1.0
    assert 2.0 * half == pytest.approx(bend, abs=1e-14 * loss + 1e-15)
    assert found == pytest.approx(length, rel=1e-13 * loss)


@given(st.floats(0.0, 100.0), st.floats(-100.0, 100.0))
def test_the_arc_ends_at_its_point(aside: float, ahead: float) -> None:
    chord = math.hypot(aside, ahead)
    half, length = arc_to(aside, ahead)
    assert 0.0 <= half <= MOST_HALF_BEND
    assert length >= chord * (1.0 - 1e-15)
    if half < 3.0 and chord > 1e-100:
        end = expm(twist_matrix(np.array([2.0 * half, 0.0, length])))[:3, 3]
        np.testing.assert_allclose(end, [aside, 0.0, ahead], atol=1e-12 * length)


@given(st.floats(1e-3, 100.0), st.floats(0.0, 3.0))
def test_it_scales_and_does_not_jump_where_it_is_called_straight(scale: float, half: float) -> None:
    assert arc_length(scale, half) == pytest.approx(scale * arc_length(1.0, half))
    assert arc_length(scale, STRAIGHT) == pytest.approx(arc_length(scale, 1.01 * STRAIGHT), rel=1e-15)


def test_a_point_straight_behind_has_a_finite_and_far_too_long_arc() -> None:
    half, length = arc_to(0.0, -1.0)
    assert half == MOST_HALF_BEND
    assert 1e6 < length < math.inf
    assert arc_to(0.0, 0.0) == (0.0, 0.0)
