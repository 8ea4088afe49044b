"""Paths of poses: splines, functions of time, and what is refused.

Laws of curves: lengths, places, tangents, and distances from them.
"""

from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import sinuous as sn
from tests.helpers import present, refused, with_each

RNG = np.random.default_rng(4)
POINTS = RNG.normal(size=(6, 3))
TIMES = np.array([0.0, 1.0, 1.5, 3.0, 4.0, 6.0])


def test_a_spline_goes_through_all_poses() -> None:
    directions = RNG.normal(size=(6, 3))
    path = sn.Path.spline(POINTS, directions=directions, between=4)
    assert len(path) == 26
    assert path.directions is not None
    np.testing.assert_allclose(present(path.positions)[::5], POINTS, atol=1e-12)
    units = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    np.testing.assert_allclose(path.directions[::5], units, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(path.directions, axis=1), 1.0, atol=1e-12)


def test_positions_and_times_are_those_of_the_cubic_spline() -> None:
    path = sn.Path.spline(POINTS, times=TIMES, between=9)
    assert path.times is not None
    np.testing.assert_allclose(path.times[::10], TIMES)
    np.testing.assert_allclose(present(path.positions), CubicSpline(TIMES, POINTS)(path.times))


def test_rotations_turn_evenly_between_two_and_smoothly_between_many() -> None:
    two = Rotation.from_rotvec([[0, 0, 0], [0.3, 0.4, 0]])
    path = sn.Path.spline(POINTS[:2], rotations=two, between=9)
    turned = Rotation.from_matrix(present(path.rotations)).as_rotvec()
    np.testing.assert_allclose(turned, np.linspace(0, 1, 11)[:, None] * [0.3, 0.4, 0], atol=1e-9)
    many = sn.Path.spline(POINTS, times=range(6), rotations=Rotation.random(6, random_state=1), between=999)
    steps = Rotation.from_matrix(many.rotations[:-1]).inv() * Rotation.from_matrix(many.rotations[1:])  # type: ignore[index]
    bends = np.linalg.norm(np.diff(steps.as_rotvec(), axis=0), axis=1)
    assert bends.max() < 0.01 * steps.magnitude().max()


def test_directions_take_the_great_circle_between_two() -> None:
    path = sn.Path.spline([[0, 0, 0], [1, 0, 0]], directions=[[0, 0, 1], [1, 0, 0]], between=1)
    np.testing.assert_allclose(present(path.directions)[1], (np.sqrt(0.5), 0, np.sqrt(0.5)), atol=1e-12)


@pytest.mark.parametrize(
    "function",
    [
        lambda t: (np.cos(t), np.sin(t), t),
        lambda t: (np.cos(t), np.sin(t), t, 0, 0, 1),
        lambda t: sn.pose((np.cos(t), np.sin(t), t)),
    ],
)
def test_a_function_of_time_is_asked_at_all_times(function: Any) -> None:
    path = sn.Path.of(function, TIMES)
    np.testing.assert_allclose(present(path.positions), np.stack([np.cos(TIMES), np.sin(TIMES), TIMES], axis=1))
    assert present(path.times).tolist() == TIMES.tolist()


def test_a_path_is_a_sequence_of_targets() -> None:
    path = sn.Path(positions=POINTS, times=TIMES)
    assert [target.position.tolist() for target in path if target.position is not None] == POINTS.tolist()
    assert path[2].equals(sn.Target(POINTS[2]))
    assert len(path[1:3]) == 2
    assert path.length == pytest.approx(np.linalg.norm(np.diff(POINTS, axis=0), axis=1).sum())
    assert repr(path) == f"Path(6 points, length {path.length:g}, times 0 to 6)"


@with_each(
    ("key", "make", "words"),
    [
        ("path", lambda: sn.Path(positions=POINTS[:1]), "expected at least two points, got 1"),
        ("path", lambda: sn.Path.spline(POINTS[:1]), "expected at least two points, got 1"),
        (
            "times[2]",
            lambda: sn.Path([0, 1, 1], positions=POINTS[:3]),
            "times must increase; expected more than 1, got 1.0",
        ),
        ("positions[2]", lambda: sn.Path.spline(POINTS[[0, 1, 1]]), "equal to the one before; expected another point"),
        (
            "directions[1]",
            lambda: sn.Path.spline(POINTS[:2], directions=[(0, 0, 1), (0, 0, -1)]),
            "opposite to the one before; expected less",
        ),
        ("function", lambda: sn.Path.of(lambda t: (1, 2), TIMES), "expected arrays (3,), (6,) or (4, 4)"),
        (
            "times[1]",
            lambda: sn.Path.of(lambda t: (1, 2, 3), [1, 0]),
            "times must increase; expected more than 1, got 0.0",
        ),
    ],
)
def test_what_is_no_path_is_refused(key: str, make: Any, words: str) -> None:
    refused(key, make, words)


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


def test_what_is_no_curve_is_refused() -> None:
    refused("curve", lambda: sn.Curve([[0, 0, 0]]), "expected at least two points")
    words = "equal to the point before; expected points that differ, got [0.0, 0.0, 0.0]"
    refused("curve[1]", lambda: sn.Curve([[0, 0, 0], [0, 0, 0], [1, 0, 0]]), words)
