"""One segment is the exponential of its twist: laws, and SciPy's matrix exponential as the judge."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import expm

from sinuous.kernels.chain import arc
from tests.helpers import (
    BENDS,
    LENGTHS,
    Floats,
    as_matrix,
    complex_columns,
    twist_matrix,
    twist_of,
)

ANGLES = (0.0, 0.5 * math.pi, 2.1, -2.9)


def pose(ux: float, uy: float, length: float) -> Floats:
    return as_matrix(*arc.pose(ux, uy, length))


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


def test_pose_is_the_exponential() -> None:
    for bend, angle, length in itertools.product(BENDS, ANGLES, LENGTHS):
        q = np.array([bend * math.cos(angle), bend * math.sin(angle), length])
        np.testing.assert_allclose(pose(*q), expm(twist_matrix(q)), atol=1e-14 * max(1.0, length), rtol=0)
        np.testing.assert_allclose(arc.point(*q), pose(*q)[:3, 3], atol=2e-15 * length, rtol=0)


def test_columns_are_the_derivatives() -> None:
    for bend, angle, length in itertools.product(BENDS, ANGLES, LENGTHS):
        q = np.array([bend * math.cos(angle), bend * math.sin(angle), length])
        rates = complex_columns(lambda x: expm(twist_matrix(x)), q)
        rotation, end, x, y, stretch = arc.pose_and_columns(*q.tolist())
        np.testing.assert_array_equal(as_matrix(rotation, end), pose(*q))
        scale = max(1.0, length)
        for got, rate in zip(
            ((*x[0], *x[1]), (*y[0], *y[1]), (0, 0, 0, *stretch)), np.moveaxis(rates, -1, 0), strict=True
        ):
            np.testing.assert_allclose(got, twist_of(rate, expm(twist_matrix(q))), atol=2e-14 * scale)
