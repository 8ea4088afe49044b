"""Winding numbers, and what is turned."""

import numpy as np
import pytest

from sinuous.scene.meshes.mending import turn_alike, turn_outwards, winding_numbers
from tests.scene.shapes import ball, cube, inverted, together


@pytest.mark.parametrize("body", [cube(), ball()])
def test_winding_numbers_count(body: tuple[np.ndarray, np.ndarray]) -> None:
    points = np.random.default_rng(0).uniform(-2.0, 2.0, (200, 3))
    corners = body[0][body[1]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inside = ((points[:, None] - corners[:, 0]) * normals).sum(axis=-1).max(axis=1) < 0.0
    assert 0 < inside.sum() < 200
    np.testing.assert_allclose(winding_numbers(points, corners), inside, atol=1e-12)
    twice = np.concatenate([corners, corners])
    np.testing.assert_allclose(winding_numbers(points, twice), 2.0 * inside, atol=1e-12)
    np.testing.assert_allclose(winding_numbers(points, corners[:, ::-1]), -1.0 * inside, atol=1e-12)


def test_nothing_is_turned_without_need() -> None:
    vertices, faces = together(cube(), inverted(cube(0.5)), cube(0.2), ball(1))
    alike, turned = turn_alike(faces)
    assert turned == 0
    np.testing.assert_array_equal(alike, faces)
    outwards, turned = turn_outwards(*together(cube(), inverted(cube(0.5)), cube(0.2)))
    assert turned == 0
    np.testing.assert_array_equal(outwards, together(cube(), inverted(cube(0.5)), cube(0.2))[1])
    assert len(vertices) > 0


def test_every_piece_is_turned_by_itself() -> None:
    """The smaller part of each piece is turned, even where most of another piece faces that way."""
    faces = together(cube(), cube())[1]
    mixed = faces.copy()
    mixed[:3] = mixed[:3, ::-1]
    mixed[15:] = mixed[15:, ::-1]
    alike, turned = turn_alike(mixed)
    assert turned == 6
    np.testing.assert_array_equal(alike[:12], faces[:12])
    np.testing.assert_array_equal(alike[12:], faces[12:, ::-1])
