"""A route as a curve: interpolated points, and the closest place."""

from itertools import pairwise

import numpy as np
import pytest

from sinuous.kernels.fitting import curve as curves
from sinuous.kernels.fitting.curve import Curve, along_of, closest_on, length_of, make_room, point_at
from sinuous.scene.obstacles import Box
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_scene


def through(points: Floats, spacing: float = 1.0) -> Curve:
    return Curve(points, spacing, np.linspace(0.0, 1.0, len(points)))


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


@pytest.mark.parametrize("seed", range(4))
def test_a_chain_as_long_as_the_curve_is_spread_evenly(seed: int) -> None:
    rng = np.random.default_rng(seed)
    curve = through(np.cumsum(rng.normal(size=(12, 3)), axis=0))
    for share in rng.uniform(size=20):
        assert along_of(curve, share) == pytest.approx(share * length_of(curve))
    make_room(curve, kernel_scene(Scene([Box((0, 0, 99), (1, 1, 1))])), 0.1, 0.9 * length_of(curve))
    assert curve.chain == pytest.approx(np.linspace(0.0, 1.0, 12))


def test_what_is_too_much_of_a_chain_goes_where_there_is_room() -> None:
    walls = Scene([Box((5.0, 0.0, z), (10.0, 10.0, 1.0)) for z in (0.7, -0.7)])
    curve = through(np.stack([np.linspace(0.0, 20.0, 81), np.zeros(81), np.zeros(81)], axis=-1), 0.25)
    make_room(curve, kernel_scene(walls), 0.1, 25.0)
    narrow = curve.points[:, 0] <= 10.0
    # Between the walls the chain is as long as the curve; beyond them lie all 5 that it is longer.
    assert curve.chain[narrow] * 25.0 == pytest.approx(curve.points[narrow, 0], abs=0.2)
    assert curve.chain[-1] == pytest.approx(1.0)
    assert (np.diff(curve.chain) > 0.0).all()
    for share in (0.0, 0.2, 0.39, 0.7, 1.0):
        assert np.interp(along_of(curve, share), curve.points[:, 0], curve.chain) == pytest.approx(share)


def test_the_length_of_a_curve_is_measured_along_its_points() -> None:
    curve = curves.curve_through(np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0]]), np.empty(3))
    assert curve.spacing == 2.0
    assert curve.chain == pytest.approx([0.0, 0.5, 1.0])
