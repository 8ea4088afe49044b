"""Bodies that overlap are kept apart, with their cavities."""

import numpy as np
import pytest

from sinuous.measures.obstacles import measure
from sinuous.scene.meshes.mesh import Mesh
from tests.scene.shapes import Triangles, ball, cube, inverted, together

HOLLOW = together(cube(1.0, (0.3, 0.2, 0.1)), inverted(cube(0.4, (0.3, 0.2, 0.1))))


@pytest.mark.parametrize(
    ("body", "count"),
    [
        (cube(), 1),
        (together(cube(), inverted(cube(0.5))), 1),
        (together(cube(), cube(1.0, (2, 0, 0)), cube(1.0, (0, 5, 0))), 1),
        (together(cube(), cube(1.0, (0.5, 0.2, 0))), 2),
        (together(cube(), cube(0.5)), 2),
        (together(cube(), ball(), cube(1.0, (3, 0, 0)), cube(1.0, (3.5, 0, 0))), 2),
        (together(cube(4.0), inverted(cube(3.0)), HOLLOW), 2),
    ],
)
def test_bodies_are_divided_where_they_may_overlap(body: Triangles, count: int) -> None:
    mesh = Mesh(*body, name="engine")
    parts = mesh.bodies()
    assert len(parts) == count
    assert sum(len(part.faces) for part in parts) == len(mesh.faces)
    assert {part.extent for part in parts} == {mesh.extent}
    assert all(part.watertight and part.defects == () and part.name == "engine" for part in parts)
    points = np.random.default_rng(0).uniform((-1.2, -1.2, -1.2), (3.5, 1.2, 1.2), (500, 3))
    united = np.min([measure(part, points) for part in parts], axis=0)
    whole = measure(mesh, points)
    np.testing.assert_array_equal(united < 0.0, whole < 0.0)
    np.testing.assert_allclose(united[united > 0.0], whole[united > 0.0], atol=1e-12)


def test_the_first_part_has_all_defects() -> None:
    parts = Mesh(*inverted(together(cube(), cube(0.5)))).bodies()
    assert [len(part.defects) for part in parts] == [1, 0]


def test_shells_and_rooms_are_not_divided() -> None:
    vertices, faces = together(cube(), cube(0.5))
    for mesh in (Mesh(vertices, faces[1:]), Mesh(vertices, faces, inside=True)):
        assert mesh.bodies() == (mesh,)
