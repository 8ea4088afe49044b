"""Slow distances to meshes are those of libigl, and of balls and boxes."""

import numpy as np
import pytest

from sinuous.measures.obstacles import measure, to_triangles
from sinuous.scene.meshes.mesh import Mesh
from tests.helpers import Floats, random_rotation
from tests.scene.shapes import Triangles, ball, cube, inverted, together

BODIES = [cube(), ball(), together(cube(), inverted(cube(0.5)), cube(0.7, (2, 0, 0)))]


def points(seed: int, count: int = 600) -> Floats:
    return np.random.default_rng(seed).uniform((-1.2, -1.2, -1.2), (2.5, 1.2, 1.2), (count, 3))


@pytest.mark.parametrize("body", BODIES)
def test_solids_agree_with_libigl(body: Triangles) -> None:
    igl = pytest.importorskip("igl")
    signed = igl.signed_distance(points(0), *body, sign_type=igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL)[0]
    assert (signed < 0.0).sum() > 5
    np.testing.assert_allclose(measure(Mesh(*body), points(0)), signed, atol=1e-12)
    np.testing.assert_allclose(measure(Mesh(*body, inside=True), points(0)), -signed, atol=1e-12)


@pytest.mark.parametrize("body", BODIES)
def test_shells_agree_with_libigl(body: Triangles) -> None:
    igl = pytest.importorskip("igl")
    vertices, faces = body[0], body[1][1:]
    plain = igl.signed_distance(points(1), vertices, faces, sign_type=igl.SIGNED_DISTANCE_TYPE_UNSIGNED)[0]
    np.testing.assert_allclose(measure(Mesh(vertices, faces), points(1)), plain, atol=1e-12)
    np.testing.assert_allclose(measure(Mesh(vertices, faces, thickness=0.3), points(1)), plain - 0.15, atol=1e-12)


def test_a_cube_is_a_box() -> None:
    turn, p = random_rotation(np.random.default_rng(2)), points(2)
    excess = np.abs(p @ turn) - 0.5
    outside = np.linalg.norm(np.maximum(excess, 0.0), axis=1)
    expected = np.where(outside > 0.0, outside, excess.max(axis=1))
    vertices, faces = cube()
    np.testing.assert_allclose(measure(Mesh(vertices @ turn.T, faces), p), expected, atol=1e-12)


def test_signs_along_a_curve_that_goes_in_and_out() -> None:
    """Between places that are near each other the sign is taken over: never across the surface."""
    turn = np.linspace(0.0, 20.0, 3000)
    curve = np.stack([1.2 * np.sin(turn), 1.2 * np.sin(1.1 * turn), 0.1 * turn - 1.0], axis=-1)
    mesh = Mesh(*together(ball(3), inverted(cube(0.6))))
    along = measure(mesh, curve)
    order = np.random.default_rng(0).permutation(3000)
    scattered = measure(mesh, curve[order])
    np.testing.assert_allclose(along[order], scattered, atol=1e-12)
    assert 0.1 < (along < 0.0).mean() < 0.9


def test_triangles_against_samples_of_them() -> None:
    """No point of a triangle is nearer, and some point of it is as near as said."""
    rng = np.random.default_rng(3)
    corners = rng.normal(size=(200, 3, 3)) * rng.choice([0.01, 1.0], (200, 1, 1))
    corners[:20, 2] = corners[:20, 1] + 1e-9
    p = rng.normal(size=(200, 3))
    found = to_triangles(corners, p)
    weights = rng.dirichlet((0.3, 0.3, 0.3), 5000)
    sampled = np.linalg.norm(np.einsum("wk,mkx->mwx", weights, corners) - p[:, None], axis=-1).min(axis=1)
    assert (found <= sampled + 1e-12).all()
    assert (found >= sampled - 0.1).all()
