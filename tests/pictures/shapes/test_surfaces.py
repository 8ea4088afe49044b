"""Drawn surfaces are where the obstacles and the body are, and face outwards."""

import numpy as np
import pytest
from numpy.typing import NDArray

import sinuous as sn
from sinuous.measures.obstacles import measure
from sinuous.pictures.shapes.body import surface as body_surface
from sinuous.pictures.shapes.body import tube
from sinuous.pictures.shapes.facets import normals
from sinuous.pictures.shapes.surfaces import MOST_TRIANGLES, obstacle_surface
from sinuous.scene.obstacles import Obstacle
from tests.helpers import Floats
from tests.scene.shapes import cube

TURNED = sn.pose(rotation=(1, 2, 3, 4))[:3, :3]


@pytest.mark.parametrize(
    "obstacle",
    [
        sn.Sphere((1, 2, 3), 2),
        sn.Box((1, 2, 3), (1, 2, 3), TURNED),
        sn.Capsule((1, 2, 3), (2, 2, 5), 1),
        sn.Cylinder((1, 2, 3), (2, 2, 5), 1),
        sn.HalfSpace((0, 0, 1), (0, 1, 1)),
    ],
    ids=lambda obstacle: type(obstacle).__name__,
)
def test_obstacles(obstacle: Obstacle) -> None:
    scene = sn.Scene([obstacle])
    surface = obstacle_surface(obstacle, np.zeros(3), 5.0)
    assert np.abs(scene.distance(surface)).max() < 1e-12
    outward, middles = normals(surface), surface.mean(axis=1)
    alike = (scene.gradient(middles + 1e-6 * outward) * outward).sum(axis=-1)
    assert alike[np.linalg.norm(outward, axis=-1) > 0.5].min() > 0.99


def test_meshes_are_cut_into_small_facets_that_face_outwards() -> None:
    mesh = sn.Mesh(*cube(2.0))
    surface = obstacle_surface(mesh, np.zeros(3), 5.0)
    assert np.linalg.norm(np.roll(surface, -1, axis=1) - surface, axis=-1).max() <= 0.2
    assert np.abs(measure(mesh, surface.reshape(-1, 3))).max() < 1e-12
    outward, middles = normals(surface), surface.mean(axis=1)
    assert (measure(mesh, (middles + 1e-3 * outward)[::9]) > 0.0).all()
    sides = np.cross(surface[:, 1] - surface[:, 0], surface[:, 2] - surface[:, 0])
    assert 0.5 * np.linalg.norm(sides, axis=-1).sum() == pytest.approx(24.0)


def test_meshes_to_stay_in_face_inwards_and_shells_both_ways() -> None:
    vertices, faces = cube()
    inside = obstacle_surface(sn.Mesh(vertices, faces, inside=True), np.zeros(3), 5.0)
    assert (np.einsum("mx,mx->m", inside.mean(axis=1), normals(inside)) < 0.0).all()
    shell = obstacle_surface(sn.Mesh(vertices, faces[1:]), np.zeros(3), 5.0)
    assert np.linalg.norm(normals(shell).sum(axis=0)) < 1e-9
    assert (np.einsum("mx,mx->m", shell.mean(axis=1), normals(shell)) < 0.0).mean() == 0.5


@pytest.mark.parametrize("obstacle", [sn.Box((1, 2, 3), (1, 2, 3), TURNED, True), sn.Sphere((1, 2, 3), 2, True)])
def test_what_the_body_must_stay_in_faces_inwards(obstacle: Obstacle) -> None:
    surface = obstacle_surface(obstacle, np.zeros(3), 5.0)
    assert np.abs(sn.Scene([obstacle]).distance(surface)).max() < 1e-12
    inwards = [1.0, 2.0, 3.0] - surface.mean(axis=1)
    assert (np.einsum("mx,mx->m", inwards, normals(surface)) >= 0.0).all()


def test_large_meshes_have_fewer_facets_in_the_same_place() -> None:
    vertices, faces = cube(2.0)
    for _ in range(6):
        vertices, faces = quartered(vertices, faces)
    assert len(faces) > MOST_TRIANGLES
    surface = obstacle_surface(sn.Mesh(vertices, faces), np.zeros(3), 5.0)
    assert 3_000 < len(surface) <= MOST_TRIANGLES
    box = sn.Scene([sn.Box((0, 0, 0), (2, 2, 2))])
    assert np.abs(box.distance(surface)).max() < 2.0 / 20


def quartered(vertices: Floats, faces: NDArray[np.int64]) -> tuple[Floats, NDArray[np.int64]]:
    """Cut every triangle in four."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
    corners = np.stack([a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca], axis=1).reshape(-1, 3)
    points, index = np.unique(corners, axis=0, return_inverse=True)
    return points, index.reshape(-1, 3)


def test_body() -> None:
    robot = sn.Robot.uniform(3, 10, radius=1, base=sn.pose((1, 2, 3), direction=(1, 1, 1)))
    q = np.array([[1.0, 2.0, 10.0], [0.0, 0.0, 10.0], [-1.0, 0.1, 10.0]])
    backbone = robot.backbone(q, 500)
    for surface in tube(robot, q, list(robot.radii)):
        middles = surface.mean(axis=1)
        away = middles[:, None] - backbone
        nearest = np.linalg.norm(away, axis=-1).argmin(axis=1)
        away = away[np.arange(len(middles)), nearest]
        assert np.abs(np.linalg.norm(away, axis=-1) - 1.0).max() < 0.1
        assert (away * normals(surface)).sum(axis=-1).min() > 0.9


def test_a_body_without_a_radius_is_drawn_thin() -> None:
    segment = body_surface(sn.Robot.uniform(1, 10), np.array([[0.0, 0.0, 10.0]]), 0.5).segments[0]
    assert np.hypot(segment[..., 0], segment[..., 1]).max() == pytest.approx(0.5)


def test_fittings_are_behind_the_base_around_the_mount_and_at_the_tool() -> None:
    robot = sn.Robot.uniform(2, 10, radius=1, mount=4, tool=sn.pose((0, 0, 3)))
    fittings = body_surface(robot, np.array([[0.0, 0.0, 10.0]] * 2), 0.1).fittings
    z = fittings[..., 2].ravel()
    assert z.min() == pytest.approx(-1.5)
    assert z.max() == pytest.approx(23.0)
    assert not ((z > 4.1) & (z < 20.0)).any()
    away = np.hypot(fittings[..., 0], fittings[..., 1]).ravel()
    assert away[(z > 1.0) & (z < 3.0)] == pytest.approx(1.25)


def test_a_segment_of_no_length_has_a_surface() -> None:
    robot = sn.Robot([sn.Segment((0, 5), max_bend=0), sn.Segment(10)], radius=1)
    parts = tube(robot, np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 10.0]]), [1.0, 1.0])
    assert all(np.isfinite(part).all() for part in parts)
