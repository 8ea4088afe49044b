"""Drawn surfaces are where the obstacles and the body are, and face outwards."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.obstacles import measure
from sinuous.pictures.surfaces import body, edges, normals, obstacle_surface
from sinuous.scene.obstacles import Obstacle
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
def test_outlines_lie_on_the_obstacle(obstacle: Obstacle) -> None:
    assert np.abs(sn.Scene([obstacle]).distance(edges(obstacle))).max() < 1e-12


def test_body() -> None:
    robot = sn.Robot.uniform(3, 10, radius=1, base=sn.pose((1, 2, 3), direction=(1, 1, 1)))
    q = np.array([[1.0, 2.0, 10.0], [0.0, 0.0, 10.0], [-1.0, 0.1, 10.0]])
    backbone = robot.backbone(q, 500)
    for surface in body(robot, q, 0.5):
        middles = surface.mean(axis=1)
        away = middles[:, None] - backbone
        nearest = np.linalg.norm(away, axis=-1).argmin(axis=1)
        away = away[np.arange(len(middles)), nearest]
        assert np.abs(np.linalg.norm(away, axis=-1) - 1.0).max() < 0.1
        assert (away * normals(surface)).sum(axis=-1).min() > 0.9


def test_a_body_without_a_radius_is_drawn_thin() -> None:
    surface = body(sn.Robot.uniform(1, 10), np.array([[0.0, 0.0, 10.0]]), 0.5)[0]
    assert np.hypot(surface[..., 0], surface[..., 1]).max() == pytest.approx(0.5)
