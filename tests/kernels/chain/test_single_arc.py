"""The single arc to a point: by the matrix exponential, and by what bounds it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from sinuous.kernels.chain.single_arc import MOST_HALF_BEND, arc_to
from tests.helpers import BENDS, twist_matrix

ARCS = [bend for bend in BENDS if bend < 2.0 * MOST_HALF_BEND]


@pytest.mark.parametrize("bend", ARCS)
@pytest.mark.parametrize("length", [1e-3, 1.0, 60.0])
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
