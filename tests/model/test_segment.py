"""Arc parameters: curvature, bending plane and length, there and back.

The stiffness of a segment, said by itself or as that of a round rod.
"""

import math
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import refused, refused_each, with_each


def test_arc_parameters_there_and_back() -> None:
    rng = np.random.default_rng(7)
    curvature, angle, length = rng.uniform(0, 3, (5, 4)), rng.uniform(-3.1, 3.1, (5, 4)), rng.uniform(0.1, 2, (5, 4))
    q = sn.from_arc_parameters(curvature, angle, length)
    assert q.shape == (5, 4, 3)
    for got, expected in zip(sn.arc_parameters(q), (curvature, angle, length), strict=True):
        np.testing.assert_allclose(got, expected, atol=1e-13)
    np.testing.assert_allclose(sn.from_arc_parameters(2.0, 0.0, [1.0, 2.0]), [[2.0, 0.0, 1.0], [4.0, 0.0, 2.0]])


def test_straight_segments_have_no_curvature_and_bent_ones_of_no_length_none_that_is_finite() -> None:
    curvature, angle, length = sn.arc_parameters([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_array_equal([curvature, angle, length], [[0, 0], [0, 0], [0, 1]])
    refused("q", lambda: sn.arc_parameters([[1.0, 0.0, 0.0]]), "length greater than 0")


@with_each("value", ["abc", None, [1.0, math.nan], [True], [[1.0], [1.0, 2.0]]])
def test_bad_arc_parameters_are_refused(value: Any) -> None:
    refused("curvature", lambda: sn.from_arc_parameters(value, 0.0, 1.0))
    refused("length", lambda: sn.from_arc_parameters(1.0, 0.0, value))
    refused("q", lambda: sn.arc_parameters(value))


# Making robots


def test_a_round_rod_has_the_stiffness_of_its_material() -> None:
    rod = sn.Stiffness(youngs_modulus=54e9, poisson=0.3, radius=0.7e-3)
    assert rod.bend == pytest.approx(0.010184, rel=1e-4)
    assert rod.twist == pytest.approx(54e9 / 2.6 * math.pi * 0.7e-3**4 / 2.0)
    assert rod.stretch == pytest.approx(54e9 * math.pi * 0.7e-3**2)


def test_what_cannot_be_is_refused() -> None:
    for key in ("bend", "twist", "stretch"):
        bad: Any = lambda value, key=key: sn.Stiffness(**({"bend": 1.0} | {key: value}))  # noqa: E731
        refused_each(key, (0.0, -1.0, math.nan, "soft"), bad)
    refused("bend", sn.Stiffness, "youngs_modulus and radius")
    refused("radius", lambda: sn.Stiffness(1.0, radius=2.0), "either")
    refused("poisson", lambda: sn.Stiffness(youngs_modulus=1.0, radius=1.0, poisson=-1.0))
