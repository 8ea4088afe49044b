"""Vectors and matrices as tuples, against NumPy."""

import numpy as np
import pytest

from sinuous.kernels.maths import vectors as v
from tests.helpers import mat, random_rotation, vec


@pytest.mark.parametrize("seed", range(5))
def test_products_are_those_of_numpy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, 3))
    m, n = rng.normal(size=(2, 3, 3))
    np.testing.assert_allclose(v.cross(vec(a), vec(b)), np.cross(a, b), atol=1e-15)
    np.testing.assert_allclose(v.mat_vec(mat(m), vec(a)), m @ a, atol=1e-14)
    np.testing.assert_allclose(v.vec_mat(vec(a), mat(m)), m.T @ a, atol=1e-14)
    np.testing.assert_allclose(v.mat_mat(mat(m), mat(n)), m @ n, atol=1e-14)
    np.testing.assert_allclose(v.add_outer(mat(m), vec(a), vec(b)), m + np.outer(a, b), atol=1e-15)


@pytest.mark.parametrize("seed", range(3))
def test_across_makes_a_right_handed_frame(seed: int) -> None:
    rng = np.random.default_rng(seed)
    directions = [
        *np.eye(3),
        *-np.eye(3),
        *random_rotation(rng),
        np.array([1e-9, 0.0, -1.0]),
        np.array([0.0, 1e-200, -1.0]),
    ]
    for a in directions:
        x, y = v.across(vec(a))
        frame = np.stack([x, y, a], axis=-1)
        np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-15)
        assert np.linalg.det(frame) > 0.0
