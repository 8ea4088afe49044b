"""Laws of curves: lengths, places, tangents, and distances from them."""

import numpy as np
import pytest

import sinuous as sn


def helix(count: int = 400) -> np.ndarray:
    t = np.linspace(0.0, 4.0, count)
    return np.stack([np.cos(t), np.sin(t), 0.5 * t], axis=1)


def test_a_place_is_as_far_along_as_it_says() -> None:
    curve = sn.Curve(helix())
    assert curve.length == pytest.approx(4.0 * np.hypot(1.0, 0.5), abs=1e-8)
    along = np.linspace(0.0, curve.length, 7)
    t = along / np.hypot(1.0, 0.5)
    np.testing.assert_allclose(curve.at(along), np.stack([np.cos(t), np.sin(t), 0.5 * t], axis=1), atol=1e-6)
    slopes = np.stack([-np.sin(t), np.cos(t), np.full(7, 0.5)], axis=1) / np.hypot(1.0, 0.5)
    np.testing.assert_allclose(curve.tangent(along), slopes, atol=1e-4)


def test_a_straight_line_in_front_belongs_to_it() -> None:
    curve, longer = sn.Curve(helix()), sn.Curve(helix(), start=(1, 0, -2))
    assert longer.length == pytest.approx(curve.length + 2.0)
    np.testing.assert_allclose(
        longer.at([0.0, 1.5, 2.0 + 3.0]), np.array([(1, 0, -2), (1, 0, -0.5), tuple(curve.at(3.0))]), atol=1e-12
    )
    np.testing.assert_allclose(longer.tangent(0.5), (0, 0, 1))
    assert longer.distance((1.3, 0, -1.0)) == pytest.approx(0.3)


def test_distances_are_those_of_brute_force() -> None:
    curve = sn.Curve(helix())
    points = np.random.default_rng(0).uniform(-2, 2, (50, 3))
    fine = curve.at(np.linspace(0.0, curve.length, 200_001))
    brute = np.array([np.linalg.norm(fine - p, axis=1).min() for p in points])
    np.testing.assert_allclose(curve.distance(points), brute, atol=1e-8)
    assert curve.distance(curve.at(np.linspace(0, curve.length, 33))).max() < 1e-12


def test_a_bezier_curve_is_that_of_de_casteljau() -> None:
    control = np.array([(0, 0, 0), (0, 0, 1.6), (2, 0, 1.3)], np.float64)
    curve = sn.Curve.bezier(control)
    for t in np.linspace(0, 1, 9):
        first = control[:-1] + t * np.diff(control, axis=0)
        assert curve.distance(first[0] + t * (first[1] - first[0])) < 1e-8


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[0, 0, 0]], "curve: expected at least two points"),
        (
            [[0, 0, 0], [0, 0, 0], [1, 0, 0]],
            r"curve\[1\]: equal to the point before; expected points that differ, got \[0.0, 0.0, 0.0\]",
        ),
    ],
)
def test_what_is_no_curve_is_refused(points: list[list[float]], message: str) -> None:
    with pytest.raises(sn.InputError, match=message):
        sn.Curve(points)
