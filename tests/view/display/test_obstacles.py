"""Drawn obstacles are where they are, and face the side where the body may be."""

import numpy as np

import sinuous as sn
from sinuous.scene.obstacles import Obstacle
from sinuous.view.display.surfaces import obstacle_surface
from sinuous.view.pictures.paint import normals_of
from tests.cases import with_each
from tests.scene.shapes import cube

TURNED = sn.pose(rotation=(1, 2, 3, 4))[:3, :3]
OBSTACLES = [
    sn.Sphere((1, 2, 3), 2),
    sn.Box((1, 2, 3), (1, 2, 3), TURNED),
    sn.Capsule((1, 2, 3), (2, 2, 5), 1),
    sn.Capsule((1, 2, 3), (1, 2, 3), 1),
    sn.Cylinder((1, 2, 3), (2, 2, 5), 1),
    sn.HalfSpace((0, 0, 1), (0, 1, 1)),
    sn.Box((1, 2, 3), (1, 2, 3), TURNED, True),
    sn.Sphere((1, 2, 3), 2, True),
    sn.Cylinder((1, 2, 3), (2, 2, 5), 1, True),
    sn.Mesh(*cube(2.0)),
    sn.Mesh(*cube(2.0), inside=True),
]


@with_each("pieces", [1, 12])
@with_each("obstacle", OBSTACLES)
def test_vertices_lie_on_the_surface_and_faces_towards_free_space(obstacle: Obstacle, pieces: int) -> None:
    surface = obstacle_surface(obstacle, np.zeros(3), 5.0, pieces=pieces)
    scene = sn.Scene([obstacle])
    assert np.abs(scene.distance(surface.vertices[np.unique(surface.faces)])).max() < 1e-12
    outward, middles = normals_of(surface.facets), surface.facets.mean(axis=1)
    alike = (scene.gradient(middles + 1e-6 * outward) * outward).sum(axis=-1)
    assert alike[np.linalg.norm(outward, axis=-1) > 0.5].min() > 0.99


@with_each("obstacle", OBSTACLES)
def test_triangles_and_faces_have_the_same_area_and_turned_ones_the_other_side(obstacle: Obstacle) -> None:
    surface = obstacle_surface(obstacle, np.zeros(3), 5.0)
    corners = surface.vertices[surface.triangles]
    of_triangles = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0)
    facets = surface.facets
    of_faces = 0.5 * np.cross(facets[:, 2] - facets[:, 0], facets[:, 3] - facets[:, 1]).sum(axis=0)
    np.testing.assert_allclose(of_triangles, of_faces, atol=1e-9)
    np.testing.assert_allclose(normals_of(surface.flipped().facets), -normals_of(facets), atol=1e-12)
