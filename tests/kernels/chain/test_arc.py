"""One segment is the exponential of its twist: laws, and SciPy's matrix exponential as the judge."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from sinuous.kernels.chain import arc
from tests.cases import with_each
from tests.helpers import (
    BENDS,
    LENGTHS,
    Floats,
    as_matrix,
    complex_columns,
    mat,
    random_pose,
    skew,
    twist_matrix,
    twist_of,
    vec,
)

ANGLES = (0.0, 0.5 * math.pi, 2.1, -2.9)
bends = st.one_of(st.sampled_from(BENDS), st.floats(0.0, 2.0 * math.pi))
angles = st.floats(-math.pi, math.pi)
lengths = st.one_of(st.sampled_from(LENGTHS), st.floats(0.0, 100.0))


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


@with_each("bend", [*BENDS, 0.3, 0.499, 0.501, 0.6, 2.0])
def test_coefficients_are_their_power_series(bend: float) -> None:
    got = arc.coefficients(bend * bend)
    np.testing.assert_allclose(got, exact_coefficients(bend * bend), rtol=4e-15, atol=1e-15)


def test_pose_is_the_exponential() -> None:
    for bend, angle, length in itertools.product(BENDS, ANGLES, LENGTHS):
        q = np.array([bend * math.cos(angle), bend * math.sin(angle), length])
        np.testing.assert_allclose(pose(*q), expm(twist_matrix(q)), atol=1e-14 * max(1.0, length), rtol=0)
        np.testing.assert_allclose(arc.point(*q), pose(*q)[:3, 3], atol=2e-15 * length, rtol=0)


@given(bends, angles, lengths, st.floats(0.0, 1.0))
def test_an_arc_is_its_two_parts_one_after_the_other(bend: float, angle: float, length: float, s: float) -> None:
    q = np.array([bend * math.cos(angle), bend * math.sin(angle), length])
    np.testing.assert_allclose(pose(*(s * q)) @ pose(*((1 - s) * q)), pose(*q), atol=1e-14 * max(1.0, length))


@given(bends, angles, lengths)
def test_the_negative_twist_goes_back(bend: float, angle: float, length: float) -> None:
    q = np.array([bend * math.cos(angle), bend * math.sin(angle), length])
    np.testing.assert_allclose(pose(*q) @ pose(*-q), np.eye(4), atol=1e-14 * max(1.0, length))


@given(bends, angles, lengths, angles)
def test_mirrored_and_turned_about_the_tangent(bend: float, angle: float, length: float, turn: float) -> None:
    ux, uy = bend * math.cos(angle), bend * math.sin(angle)
    mirror = np.diag([1.0, -1.0, 1.0, 1.0])
    scale = max(1.0, length)
    np.testing.assert_allclose(mirror @ pose(ux, uy, length) @ mirror, pose(ux, -uy, length), atol=1e-15 * scale)
    c, s = math.cos(turn), math.sin(turn)
    about = as_matrix([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], np.zeros(3))
    turned = pose(c * ux - s * uy, s * ux + c * uy, length)
    np.testing.assert_allclose(about @ pose(ux, uy, length) @ about.T, turned, atol=1e-14 * scale)


def test_without_bend_and_length_nothing_moves() -> None:
    np.testing.assert_array_equal(pose(0.0, 0.0, 0.0), np.eye(4))
    np.testing.assert_array_equal(pose(1.0, -2.0, 0.0)[:3, 3], np.zeros(3))


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


@pytest.mark.parametrize("seed", range(3))
def test_carry_is_the_adjoint(seed: int) -> None:
    rng = np.random.default_rng(seed)
    frame = random_pose(rng)
    omega, v = rng.normal(size=(2, 3))
    twist = np.zeros((4, 4))
    twist[:3, :3], twist[:3, 3] = skew(omega), v
    seen = frame @ twist @ np.linalg.inv(frame)
    turned, moved = arc.carry(mat(frame[:3, :3]), vec(frame[:3, 3]), vec(omega), vec(v))
    np.testing.assert_allclose(skew(turned), seen[:3, :3], atol=1e-14)
    np.testing.assert_allclose(moved, seen[:3, 3], atol=1e-14)
