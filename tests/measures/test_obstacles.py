"""Slow distances to exact obstacles are those of the kernels."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures import obstacles
from sinuous.measures.obstacles import Indices, least_distances, measure, that_matter
from tests.helpers import Floats
from tests.scene.shapes import EACH_KIND, ball, cube, inverted, together


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("spread", [0.0, 1.0, 8.0])
def test_no_ball_is_passed_over(monkeypatch: pytest.MonkeyPatch, seed: int, spread: float) -> None:
    """Radii of one size, of all sizes, and of many orders of magnitude, looked at in small blocks."""
    monkeypatch.setattr(obstacles, "PAIRS", 50)
    monkeypatch.setattr(obstacles, "BLOCK", 200)
    rng = np.random.default_rng(seed)
    centers, points = rng.normal(size=(300, 3)), 2.0 * rng.normal(size=(60, 3))
    radii = 0.2 * np.exp(-spread * rng.random(300))

    def exact(point: Indices, ball: Indices) -> Floats:
        gaps: Floats = np.linalg.norm(points[point] - centers[ball], axis=-1)
        return gaps - radii[ball]

    expected = (np.linalg.norm(points[:, None] - centers, axis=-1) - radii).min(axis=1)
    np.testing.assert_allclose(least_distances(points, centers, radii, exact), expected, atol=1e-14)


def test_signs_along_a_curve_that_goes_in_and_out() -> None:
    """Between places that are near each other the sign is taken over: never across the surface."""
    turn = np.linspace(0.0, 20.0, 1500)
    curve = np.stack([1.2 * np.sin(turn), 1.2 * np.sin(1.1 * turn), 0.1 * turn - 1.0], axis=-1)
    mesh = sn.Mesh(*together(ball(3), inverted(cube(0.6))))
    along = measure(mesh, curve)
    order = np.random.default_rng(0).permutation(1500)
    scattered = measure(mesh, curve[order])
    np.testing.assert_allclose(along[order], scattered, atol=1e-12)
    assert 0.1 < (along < 0.0).mean() < 0.9


def test_who_is_left_out_matters_to_no_body() -> None:
    rng = np.random.default_rng(0)
    some = [*(make() for make in EACH_KIND.values()), *(sn.Sphere(place, 0.1) for place in rng.uniform(-3, 3, (60, 3)))]
    runs = rng.uniform(-3, 3, (60, 4, 1, 3)) + np.cumsum(0.1 * rng.normal(size=(60, 4, 9, 3)), axis=2)
    sizes = rng.uniform(0.0, 0.2, (2, 1, 4)) + np.zeros((2, 60, 4))
    exact = np.array([measure(own, runs.reshape(-1, 3)).reshape(runs.shape[:3]).min(axis=2) for own in some])
    left = np.full_like(exact, np.inf)
    for i, near in that_matter(some, runs, sizes):
        left[i, near] = exact[i, near]
    for size in sizes:
        np.testing.assert_array_equal((left - size).min(axis=(0, 2)), (exact - size).min(axis=(0, 2)))
    assert np.isfinite(left).mean() < 0.5
