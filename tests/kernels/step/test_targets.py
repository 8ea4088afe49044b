"""Errors of targets as rotation vectors; the rows that a step reads of them are judged by its dense problem."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from sinuous.kernels.step import targets
from tests.helpers import Floats, mat, skew, vec

TURNS = (0.0, 1e-200, 1e-12, 1e-9, 1e-5, 1e-3, 1.0, 2.5, math.pi - 1e-3, math.pi - 1e-5, math.pi - 1e-9, math.pi)
turns = st.one_of(st.sampled_from(TURNS), st.floats(0.0, math.pi))
axes = st.one_of(
    st.sampled_from(
        [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 1.0, 0.0), (-1.0, 1.0, -1.0), (1.0, 1e-9, 0.0)]
    ),
    st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda a: math.hypot(*a) > 1e-3),
)
units = axes.map(lambda a: np.array(a) / np.linalg.norm(a))


def assert_logarithm(angle: float, axis: Floats) -> None:
    rotation = expm(skew(angle * axis))
    got = np.array(targets.rotation_vector(mat(rotation)))
    assert np.linalg.norm(got) == pytest.approx(angle, abs=1e-14, rel=1e-9)
    # Only its root is known of a matrix close to a half turn: the axis to half of the digits.
    tolerance = 1e-8 if angle > math.pi - 1e-3 else 1e-11
    np.testing.assert_allclose(expm(skew(got)), rotation, atol=tolerance)


@given(turns, units)
def test_rotation_vector_undoes_the_exponential(angle: float, axis: Floats) -> None:
    assert_logarithm(angle, axis)


@given(turns, units, units)
def test_direction_vector_is_the_shortest_turn(angle: float, tangent: Floats, other: Floats) -> None:
    side = np.cross(tangent, other)
    if np.linalg.norm(side) < 1e-6:
        side = np.cross(tangent, [1.0, 0.0, 0.0] if abs(tangent[0]) < 0.9 else [0.0, 1.0, 0.0])
    goal = expm(skew(angle * side / np.linalg.norm(side))) @ tangent
    got = np.array(targets.direction_vector(vec(tangent), vec(goal)))
    assert np.linalg.norm(got) == pytest.approx(angle, abs=1e-14, rel=1e-7)
    assert abs(got @ tangent) < 1e-7
    np.testing.assert_allclose(expm(skew(got)) @ tangent, goal, atol=1e-8 if angle > math.pi - 1e-3 else 1e-13)
