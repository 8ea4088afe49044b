"""Normals of faces, edges and corners."""

import numpy as np
import pytest

from sinuous.scene.prepared.trees import part_normals
from tests.scene import shapes


def test_a_cube_has_the_normals_that_one_sees() -> None:
    vertices, faces = shapes.cube()
    normals = part_normals(vertices, faces)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1.0, atol=1e-12)
    corners = vertices[faces]
    np.testing.assert_allclose(normals[:, 4:], corners / np.linalg.norm(corners, axis=-1, keepdims=True), atol=1e-12)
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    for face in range(len(faces)):
        assert sorted(abs(normals[face, 0])) == pytest.approx([0.0, 0.0, 1.0])
        for edge in range(3):
            outward = np.where(abs(middles[face, edge]) > 0.49, middles[face, edge], 0.0)
            np.testing.assert_allclose(normals[face, 1 + edge], outward / np.linalg.norm(outward), atol=1e-12)


def test_a_ball_has_radial_normals() -> None:
    vertices, faces = shapes.ball(3)
    normals = part_normals(vertices, faces)
    corners = vertices[faces]
    assert (normals[:, 4:] * corners).sum(axis=-1).min() > 0.999
    assert (normals[:, 0] * corners.mean(axis=1)).sum(axis=-1).min() > 0.98


def test_triangles_that_cancel_have_none() -> None:
    """Two triangles back to back: no direction is better than another, and none is NaN."""
    normals = part_normals(np.eye(3), np.array([[0, 1, 2], [0, 2, 1]]))
    assert np.isfinite(normals).all()
    np.testing.assert_allclose(normals[:, 1:], 0.0, atol=1e-15)
