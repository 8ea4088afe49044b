"""The closest point of one triangle: against all its points, and the part that it lies on."""

import math

import numpy as np
import pytest

from sinuous.kernels.fields import triangles
from sinuous.kernels.fields.triangles import AB, BC, CA, INSIDE, A, B, C
from sinuous.scene.prepared.trees import with_planes
from tests.helpers import Floats, vec

CORNERS = {
    INSIDE: [True, True, True],
    AB: [True, True, False],
    BC: [False, True, True],
    CA: [True, False, True],
    A: [True, False, False],
    B: [False, True, False],
    C: [False, False, True],
}
"""Which corners have a share in a point of a part."""


def weights(corners: Floats, point: Floats) -> Floats:
    return np.asarray(np.linalg.lstsq(np.vstack([corners.T, np.ones(3)]), [*point, 1.0])[0])


@pytest.mark.parametrize("seed", range(5))
def test_no_point_of_the_triangle_is_closer(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(3, 3))
    store = np.concatenate([[7.0], with_planes(corners[None])[0]])
    grid = rng.dirichlet(np.full(3, 0.5), 4000) @ corners
    parts = set()
    for p in rng.normal(size=(200, 3)) * 2.0:
        way, part = triangles.offset(store, 1, vec(p))
        foot = p - way
        share = weights(corners, foot)
        assert share == pytest.approx(share.clip(0.0, 1.0), abs=1e-9)
        np.testing.assert_allclose(share @ corners, foot, atol=1e-9)
        assert np.linalg.norm(grid - p, axis=1).min() >= np.linalg.norm(way) - 1e-12
        used = share > 1e-9
        np.testing.assert_array_equal(used, CORNERS[part])
        parts.add(part)
    assert len(parts) >= 6


def test_a_needle_has_a_distance_too() -> None:
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-9, 0.0]])
    for x in (0.1, 0.5, 0.9):
        for height in (1e-3, 1.0, 100.0):
            way, _ = triangles.offset(with_planes(corners[None])[0], 0, (x, 0.0, height))
            assert math.hypot(*way) == pytest.approx(height, rel=1e-12)


def test_a_plane_too_far_is_enough_to_know() -> None:
    store = with_planes(np.array([[[0.0, 0, 1], [2, 0, 1], [0, 3, 1]]]))[0]
    np.testing.assert_allclose(store[9:], [0.0, 0.0, 1.0, 1.0])
    assert triangles.square_distance(store, 0, (0.5, 0.5, 3.0), math.inf) == pytest.approx(4.0)
    assert triangles.square_distance(store, 0, (-1.0, 0.0, 3.0), math.inf) == pytest.approx(5.0)
    assert triangles.square_distance(store, 0, (-1.0, 0.0, 3.0), 4.5) == pytest.approx(5.0)
    assert triangles.square_distance(store, 0, (-1.0, 0.0, 3.0), 3.9) == 3.9
