"""Slow distances to exact obstacles are those of the kernels."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures import obstacles
from sinuous.measures.obstacles import Indices, least_distances, measure, that_matter, to_triangles
from tests.helpers import Floats, with_each
from tests.scene.shapes import Triangles, ball, cube, inverted, together

OBSTACLES = [
    sn.Sphere((0.2, 0.3, 1.0), 0.5),
    sn.Sphere((0.2, 0.3, 1.0), 3.0, inside=True),
    sn.Box((0.5, 0, 0.5), (0.4, 0.6, 0.8), (0.9, 0.1, 0.3, 0.2)),
    sn.Box((0.5, 0, 0.5), (4, 6, 8), (0.9, 0.1, 0.3, 0.2), inside=True),
    sn.Capsule((0, 0, 1), (1, 0, 2), 0.3),
    sn.Capsule((0, 0, 1), (0, 0, 1), 0.3),
    sn.Cylinder((0, 0, 1), (1, 0.5, 2), 0.3),
    sn.Cylinder((0, 0, -5), (1, 0.5, 5), 4.0, inside=True),
    sn.HalfSpace((0, 0, -1), (0.1, 0, 1)),
]


@with_each("obstacle", OBSTACLES)
def test_distances_agree_with_the_kernels(obstacle: sn.Sphere) -> None:
    points = np.random.default_rng(0).uniform(-3, 3, (2000, 3))
    np.testing.assert_allclose(measure(obstacle, points), sn.Scene([obstacle]).distance(points), atol=1e-12)


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


def points(seed: int, count: int = 300) -> Floats:
    return np.random.default_rng(seed).uniform(-3.0, 3.0, (count, 3))


@pytest.mark.parametrize("kind", ["one", "many", "none"])
def test_a_cloud_is_a_union_of_spheres(kind: str) -> None:
    rng = np.random.default_rng(0)
    centers = rng.normal(size=(50, 3))
    radii = {"one": np.full(50, 0.2), "many": rng.uniform(0.01, 0.5, 50), "none": np.zeros(50)}[kind]
    each = [np.linalg.norm(points(0) - c, axis=1) - r for c, r in zip(centers, radii, strict=True)]
    np.testing.assert_allclose(measure(sn.PointCloud(centers, radii), points(0)), np.min(each, axis=0), atol=1e-13)


def test_occupied_cells_are_boxes() -> None:
    occupied = np.random.default_rng(1).random((5, 6, 7)) < 0.2
    grid = sn.Grid(occupied, (-1, -2, -1), 0.5)
    boxes = [sn.Box(grid.origin + 0.5 * index, (0.5, 0.5, 0.5)) for index in np.argwhere(occupied)]
    each = [measure(box, points(1)) for box in boxes]
    np.testing.assert_allclose(measure(grid, points(1)), np.min(each, axis=0), atol=1e-13)


def unit_ball(p: Any) -> Floats:
    return np.asarray(np.linalg.norm(p, axis=-1) - 1.0)


def test_a_grid_of_distances_proves_less_than_the_truth_and_not_much_less() -> None:
    index = np.moveaxis(np.indices((21, 21, 21)), 0, -1)
    grid = sn.Grid(unit_ball(0.2 * index - 2.0), (-2, -2, -2), 0.2)
    p = points(3, 3000)
    within = (np.abs(p) <= 2.0).all(axis=1)
    proved = measure(grid, p)
    assert 500 < within.sum() < 2500
    assert (proved <= unit_ball(p) + 1e-12).all()
    assert (proved >= unit_ball(p) - 0.2 * np.sqrt(3.0))[within].all()
    on_grid = grid.origin + 0.2 * index[::5, ::5, ::5].reshape(-1, 3)
    np.testing.assert_allclose(measure(grid, on_grid), unit_ball(on_grid), atol=1e-12)


BODIES = [cube(), ball(), together(cube(), inverted(cube(0.5)), cube(0.7, (2, 0, 0)))]


def near_points(seed: int, count: int = 600) -> Floats:
    return np.random.default_rng(seed).uniform((-1.2, -1.2, -1.2), (2.5, 1.2, 1.2), (count, 3))


@pytest.mark.parametrize("body", BODIES)
def test_solids_agree_with_libigl(body: Triangles) -> None:
    igl = pytest.importorskip("igl")
    signed = igl.signed_distance(near_points(0), *body, sign_type=igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL)[0]
    assert (signed < 0.0).sum() > 5
    np.testing.assert_allclose(measure(sn.Mesh(*body), near_points(0)), signed, atol=1e-12)
    np.testing.assert_allclose(measure(sn.Mesh(*body, inside=True), near_points(0)), -signed, atol=1e-12)


@pytest.mark.parametrize("body", BODIES)
def test_shells_agree_with_libigl(body: Triangles) -> None:
    igl = pytest.importorskip("igl")
    vertices, faces = body[0], body[1][1:]
    plain = igl.signed_distance(near_points(1), vertices, faces, sign_type=igl.SIGNED_DISTANCE_TYPE_UNSIGNED)[0]
    np.testing.assert_allclose(measure(sn.Mesh(vertices, faces), near_points(1)), plain, atol=1e-12)
    np.testing.assert_allclose(
        measure(sn.Mesh(vertices, faces, thickness=0.3), near_points(1)), plain - 0.15, atol=1e-12
    )


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


def test_who_is_left_out_matters_to_no_body() -> None:
    rng = np.random.default_rng(0)
    mesh = sn.Mesh(*cube(1.0, (2.0, 2.0, 2.0)))
    cloud = sn.PointCloud(rng.uniform(-3, 3, (20, 3)), 0.1)
    some = [*OBSTACLES, mesh, cloud, *(sn.Sphere(place, 0.1) for place in rng.uniform(-3, 3, (60, 3)))]
    runs = rng.uniform(-3, 3, (5, 4, 1, 3)) + np.cumsum(0.02 * rng.normal(size=(5, 4, 9, 3)), axis=2)
    sizes = rng.uniform(0.0, 0.2, (2, 1, 4)) + np.zeros((2, 5, 4))
    exact = np.array([measure(own, runs.reshape(-1, 3)).reshape(runs.shape[:3]).min(axis=2) for own in some])
    left = np.full_like(exact, np.inf)
    for i, near in that_matter(some, runs, sizes):
        left[i, near] = exact[i, near]
    for size in sizes:
        np.testing.assert_array_equal((left - size).min(axis=(0, 2)), (exact - size).min(axis=(0, 2)))
    assert np.isfinite(left).mean() < 0.5
