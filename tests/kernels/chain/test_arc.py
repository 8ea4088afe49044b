"""One segment is the exponential of its twist: laws, and SciPy's matrix exponential as the judge.

The single arc to a point: by the matrix exponential, and by what bounds it.

How fast places of the body move: bounds against differences.
"""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from sinuous.kernels.chain import arc
from sinuous.kernels.chain.rates import MOTION_RATES_WIDTH, acceleration_bound, measure_rates
from sinuous.kernels.chain.single_arc import MOST_HALF_BEND, arc_to
from sinuous.kernels.packing import plain_rows
from tests.helpers import BENDS, Floats, frames_of, twist_matrix


def exact_coefficients(x: float) -> list[float]:
    """S, G, H, D as exact rational sums of their power series."""
    terms = [(-Fraction(x)) ** j for j in range(70)]
    s, g, h = (sum(t / math.factorial(2 * j + m) for j, t in enumerate(terms)) for m in (1, 2, 3))
    d = -sum(
        terms[j - 1] * (Fraction(1, math.factorial(2 * j + 1)) - Fraction(2, math.factorial(2 * j + 2)))
        for j in range(1, len(terms))
    )
    return [float(value) for value in (s, g, h, d)]


@pytest.mark.parametrize("bend", [*BENDS, 0.3, 0.499, 0.501, 0.6, 2.0])
def test_coefficients_are_their_power_series(bend: float) -> None:
    got = arc.coefficients(bend * bend)
    np.testing.assert_allclose(got, exact_coefficients(bend * bend), rtol=4e-15, atol=1e-15)


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


STEP = 1e-3


def way(rng: np.random.Generator, n: int) -> tuple[Floats, Floats]:
    """Two configurations (n, 3) with bends up to a whole turn and lengths down to 0."""
    shapes = rng.uniform(-math.pi, math.pi, (2, n, 3))
    shapes[..., 2] = rng.uniform(0.0, 1.5, (2, n)) * (rng.random((2, n)) < 0.9)
    return shapes[0], shapes[1]


def place(q0: Floats, q1: Floats, t: float, k: int, s: float) -> Floats:
    """Where the fraction `s` of segment `k` is at time t."""
    q = ((1.0 - t) * q0 + t * q1)[: k + 1].copy()
    q[k] *= s
    return np.asarray(frames_of(q)[-1, 9:], np.float64)


@pytest.mark.parametrize("seed", range(6))
def test_no_place_bows_more_than_its_bound_nor_travels_farther(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 6))
    q0, q1 = way(rng, n)
    rates = np.empty((n, MOTION_RATES_WIDTH))
    travel = measure_rates(plain_rows(len(q0)), q0, q1, rates)
    for _ in range(40):
        k, s, t = int(rng.integers(n)), float(rng.random()), float(rng.uniform(STEP, 1.0 - STEP))
        before, here, after = (place(q0, q1, t + d, k, s) for d in (-STEP, 0.0, STEP))
        bound = acceleration_bound(rates, k, max(q0[k, 2], q1[k, 2]), s)
        assert np.linalg.norm(before - 2.0 * here + after) / STEP**2 <= bound * (1.0 + 1e-2) + 1e-6
        assert np.linalg.norm(after - before) <= 2.0 * STEP * travel * (1.0 + 1e-6) + 1e-12
