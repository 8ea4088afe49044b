"""A route as a curve: interpolated points, and the closest place."""

from itertools import pairwise

import numpy as np
import pytest

from sinuous.kernels.fitting import curve as curves
from sinuous.kernels.fitting.curve import Curve, closest_on, length_of, point_at
from tests.helpers import Floats


def through(points: Floats, spacing: float = 1.0) -> Curve:
    return Curve(points, spacing)


def test_a_point_of_a_curve_is_interpolated() -> None:
    curve = through(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]]))
    assert length_of(curve) == 2.0
    for along, point in ((-1.0, (0, 0, 0)), (0.25, (0.25, 0, 0)), (1.5, (1, 0.5, 0)), (9.0, (1, 1, 0))):
        assert point_at(curve, along) == pytest.approx(point)


@pytest.mark.parametrize("seed", range(4))
def test_the_closest_place_is_closest(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = np.cumsum(rng.normal(size=(12, 3)), axis=0)
    dense = np.concatenate([np.linspace(a, b, 400) for a, b in pairwise(points)])
    for p in rng.normal(size=(20, 3)) * 3.0:
        foot, tangent = closest_on(through(points), tuple(p), 5.0, 100.0)
        assert np.linalg.norm(p - foot) <= np.linalg.norm(dense - p, axis=1).min() + 1e-12
        assert np.linalg.norm(tangent) == pytest.approx(1.0)


def test_no_place_is_looked_for_outside_the_window() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0]])
    foot, _ = closest_on(through(points), (4.0, 1.0, 0.0), 1.0, 1.0)
    assert foot == pytest.approx((2.0, 0.0, 0.0))


def test_points_that_coincide_do_no_harm() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0]])
    foot, tangent = closest_on(through(points), (1.5, 1.0, 0.0), 1.0, 9.0)
    assert foot == pytest.approx((1.5, 0.0, 0.0))
    assert tangent == pytest.approx((1.0, 0.0, 0.0))


def test_the_length_of_a_curve_is_measured_along_its_points() -> None:
    curve = curves.curve_through(np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0]]))
    assert (curve.spacing, length_of(curve)) == (2.0, 4.0)
