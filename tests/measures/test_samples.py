"""Slow distances to clouds, grids and fields."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.obstacles import measure
from tests.helpers import Floats


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


def test_nothing_occupied_is_infinitely_far() -> None:
    assert (measure(sn.Grid(np.zeros((2, 2, 2), bool), (0, 0, 0), 1), points(2)) == np.inf).all()


def ball(p: Any) -> Floats:
    return np.asarray(np.linalg.norm(p, axis=-1) - 1.0)


def test_a_grid_of_distances_proves_less_than_the_truth_and_not_much_less() -> None:
    index = np.moveaxis(np.indices((21, 21, 21)), 0, -1)
    grid = sn.Grid(ball(0.2 * index - 2.0), (-2, -2, -2), 0.2)
    p = points(3, 3000)
    within = (np.abs(p) <= 2.0).all(axis=1)
    proved = measure(grid, p)
    assert 500 < within.sum() < 2500
    assert (proved <= ball(p) + 1e-12).all()
    assert (proved >= ball(p) - 0.2 * np.sqrt(3.0))[within].all()
    on_grid = grid.origin + 0.2 * index[::5, ::5, ::5].reshape(-1, 3)
    np.testing.assert_allclose(measure(grid, on_grid), ball(on_grid), atol=1e-12)


def test_out_of_a_grid_of_distances_nothing_is_free_that_it_does_not_prove() -> None:
    grid = sn.Grid(np.full((3, 3, 3), 0.5), (0, 0, 0), 1.0)
    np.testing.assert_allclose(measure(grid, np.array([[1, 1, 2.5], [1, 1, 3.0], [9, 1, 1]])), [0, -0.5, -6.5])


def test_a_field_answers_itself() -> None:
    field = sn.Field(ball, (-1, -1, -1), (1, 1, 1), 0.5)
    np.testing.assert_array_equal(measure(field, points(4)), ball(points(4)))
