"""Which edges of a mesh stick out."""

import numpy as np
import pytest

from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from sinuous.solver.routing.edges import MOST, SMOOTH, rims_of, walls_of
from tests.helpers import Floats

CORNERS = np.array([(x, y, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
FACES += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]


def prism(outline: Floats) -> Mesh:
    """A solid between two copies of an outline (n, 2) that is seen from its first corner."""
    n = len(outline)
    vertices = np.concatenate([np.column_stack([outline, np.full(n, z)]) for z in (0.0, 1.0)])
    caps = [(0, i + 1, i) for i in range(1, n - 1)] + [(n, n + i, n + i + 1) for i in range(1, n - 1)]
    sides = [f for i in range(n) for j in [(i + 1) % n] for f in [(i, j, n + j), (i, n + j, n + i)]]
    return Mesh(vertices, caps + sides)


def test_a_cube_has_twelve_edges_and_ways_off_both_faces() -> None:
    walls = walls_of(Scene([Mesh(CORNERS, FACES)]).snapshot())
    assert walls.edges.shape == (12, 10)
    assert walls.triangles.shape == (12, 12)
    middles, ways = walls.edges[:, :3], walls.edges[:, 3:6]
    assert np.allclose(np.sort(np.abs(ways), axis=1), (0, 1, 1))
    assert np.allclose((ways * (middles - 0.5)).sum(axis=1), 1.0)
    assert np.allclose(walls.edges[:, 9], 0.5)
    assert np.allclose(np.linalg.norm(walls.edges[:, 6:9], axis=1), 1.0)


def test_an_edge_in_a_corner_does_not_stick_out() -> None:
    bracket = prism(np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], np.float64))
    upright = [edge for edge in walls_of(Scene([bracket]).snapshot()).edges if abs(edge[8]) > 0.5]
    assert len(upright) == 5
    assert not any(np.allclose(edge[:2], (1, 1)) for edge in upright)


@pytest.mark.parametrize(("sides", "found"), [(8, True), (MOST, False)])
def test_what_has_very_many_edges_is_no_wall(sides: int, found: bool) -> None:
    angles = 2.0 * np.pi * np.arange(sides) / sides
    post = prism(np.column_stack([np.cos(angles), np.sin(angles)]))
    assert (len(walls_of(Scene([post]).snapshot()).edges) > 0) == found


@pytest.mark.parametrize(("rings", "found"), [(2, True), (2 * SMOOTH, False)])
def test_what_is_mostly_smooth_is_no_wall(rings: int, found: bool) -> None:
    angles = 2.0 * np.pi * np.arange(40) / 40
    outline = np.column_stack([np.cos(angles), np.sin(angles)])
    vertices = np.concatenate([np.column_stack([outline, np.full(40, z)]) for z in range(rings)])
    top = 40 * (rings - 1)
    faces = [(0, i + 1, i) for i in range(1, 39)] + [(top, top + i, top + i + 1) for i in range(1, 39)]
    for ring in range(0, top, 40):
        for i, j in zip(range(40), [*range(1, 40), 0], strict=True):
            faces += [(ring + i, ring + j, ring + 40 + j), (ring + i, ring + 40 + j, ring + 40 + i)]
    scene = Scene([Mesh(vertices, faces)]).snapshot()
    assert (len(walls_of(scene).edges) == 80) == found
    assert len(rims_of(scene)) == 80


def test_shells_and_other_obstacles_have_none() -> None:
    shell = Mesh(CORNERS, FACES[:-1])
    within = Mesh(5.0 * CORNERS, FACES, inside=True)
    scene = Scene([shell, within, Sphere((3, 0, 0), 1.0)]).snapshot()
    walls = walls_of(scene)
    assert (len(walls.edges), len(walls.triangles), len(rims_of(scene))) == (0, 0, 0)


def test_edges_are_looked_for_once() -> None:
    cube = Mesh(CORNERS, FACES)
    first, again = (walls_of(Scene([cube, Sphere((3, 0, 0), x)]).snapshot()) for x in (1.0, 2.0))
    assert np.array_equal(first.edges, again.edges)
