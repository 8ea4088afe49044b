"""The nearest of many things is that of all of them."""

import numpy as np
import pytest

from sinuous.measures import obstacles
from sinuous.measures.obstacles import Indices, least_distances
from tests.helpers import Floats


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


def test_one_thing_and_no_point() -> None:
    def exact(point: Indices, thing: Indices) -> Floats:
        return np.full(len(point), 3.0)

    assert least_distances(np.ones((1, 3)), np.zeros((1, 3)), np.zeros(1), exact) == 3.0
    assert least_distances(np.ones((0, 3)), np.zeros((1, 3)), np.zeros(1), exact).shape == (0,)
