"""Edges, areas and volumes of triangles."""

import numpy as np
import pytest

from sinuous.scene.meshes import mending
from sinuous.scene.meshes.mending import Edges
from tests.helpers import random_rotation
from tests.scene.shapes import ball, cube, inverted, soup, together


def test_edges_are_counted() -> None:
    faces = cube()[1]
    assert mending.count_edges(faces) == Edges(0, 0, 0)
    assert mending.count_edges(faces).closed
    assert mending.count_edges(faces[1:]) == Edges(3, 0, 0)
    assert mending.count_edges(np.concatenate([faces, faces[:1]])) == Edges(0, 3, 0)
    assert mending.count_edges(np.concatenate([faces[:1, ::-1], faces[1:]])) == Edges(0, 0, 3)


def test_vertices_are_merged_where_they_are_exactly_equal() -> None:
    for body in (cube(), ball()):
        vertices, faces = mending.merge_equal(*soup(body))
        assert len(vertices) == len(body[0])
        np.testing.assert_array_equal(vertices[faces], body[0][body[1]])
    close = np.array([[0.0, 0.0, 0.0], [np.nextafter(0.0, 1.0), 0.0, 0.0]])
    assert len(mending.merge_equal(close, np.array([[0, 1, 1]]))[0]) == 2


def test_unused_vertices_are_dropped() -> None:
    vertices, faces = cube()
    kept, renumbered = mending.drop_unused(vertices, faces[:3])
    assert len(kept) == len(np.unique(faces[:3]))
    np.testing.assert_array_equal(kept[renumbered], vertices[faces[:3]])


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_volumes(size: float) -> None:
    turn, away = random_rotation(np.random.default_rng(0)), np.array([3.0, -2.0, 5.0])
    vertices, faces = together(cube(2.0), inverted(cube()))
    moved = size * (vertices @ turn.T + away)
    assert mending.enclosed_volume(moved, faces) == pytest.approx(7.0 * size**3)
    assert mending.enclosed_volume(moved, faces[:, ::-1]) == pytest.approx(-7.0 * size**3)
    assert mending.enclosed_volume(moved * [1.0, 1.0, 0.0], faces) == 0.0


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_triangles_have_an_area(size: float) -> None:
    vertices = size * np.array([[0, 0, 0], [1, 0, 0], [0.5, 1e-6, 0], [0.5, 1e-14, 0], [2, 0, 0]])
    faces = np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4], [1, 1, 2]])
    np.testing.assert_array_equal(mending.are_triangles(vertices, faces), [True, False, False, False])
