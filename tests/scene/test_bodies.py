"""Bodies that overlap are kept apart, with their cavities."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.obstacles import measure
from sinuous.scene.triangles import bodies_overlap, cuts_itself
from tests.helpers import random_rotation, refused, with_each
from tests.scene.shapes import Triangles, ball, cube, inverted, together, torus


def turned(body: Triangles, rng: np.random.Generator, size: float = 1.0, at: float = 0.0) -> Triangles:
    """The same, turned, scaled and moved: nothing depends on that."""
    return size * (body[0] @ random_rotation(rng).T + at), body[1]


def sized(body: Triangles, size: float) -> Triangles:
    return size * body[0], body[1]


BEAM = (np.array([5.0, 0.2, 0.2]) * cube()[0], cube()[1])


@with_each(
    ("body", "overlap"),
    [
        (cube(), False),
        (together(cube(), inverted(cube(0.5))), False),
        (together(cube(), cube(0.994)), True),
        (together(cube(), cube(1.0, (0.994, 0.3, 0.2))), True),
        (together(cube(), cube(1.0, (1.000001, 0.3, 0.2))), False),
        (together(cube(), cube(1.0, (1.0, 0.0, 0.0))), False),
        (together(cube(), cube(1.0, (1.0, 0.3, 0.2))), False),
        (together(cube(), cube(1.0, (0.999, 0.0, 0.0))), True),
        (together(cube(), cube()), True),
        (together(cube(), BEAM), True),
        (together(ball(3), sized(ball(3), 0.2)), True),
        (together(ball(3), inverted(sized(ball(3), 0.5)), sized(ball(3), 0.2)), False),
        (together(ball(3), inverted(sized(ball(3), 0.5)), sized(ball(3), 0.499999)), False),
        (together(cube(), inverted(cube(0.5, (0.4, 0.0, 0.0)))), True),
        (together(cube(), inverted(cube(0.5, (0.2, 0.0, 0.0)))), False),
    ],
)
@with_each("place", [(1.0, 0.0), (1e-3, 0.0), (1.0, 40.0)])
def test_bodies_of_one_mesh_that_overlap_are_found_however_little_they_do(
    body: Triangles, overlap: bool, place: tuple[float, float]
) -> None:
    vertices, faces = turned(body, np.random.default_rng(3), *place)
    assert bodies_overlap(vertices, faces) == overlap


@pytest.mark.parametrize("second", [cube(0.994), cube(1.0, (0.994, 0.3, 0.2)), cube()])
def test_a_thin_wall_between_overlapping_bodies_is_never_free(second: Triangles) -> None:
    """Nearer to each other than samples are: the mesh is refused, and its bodies one by one are not."""
    mesh = sn.Mesh(*together(cube(), second), name="engine")
    refused("engine", lambda: sn.Scene([mesh]).prepare(), "cuts through itself")
    inside = np.array([[0.4985, 0.3, 0.2], [0.4985, 0.0, 0.0]])
    assert (sn.Scene(mesh.bodies()).distance(inside) < 0.0).all()


def at_a_corner(other: Triangles) -> Triangles:
    """A cube and another body whose first vertex is that of the cube: one piece."""
    vertices, faces = together(cube(), other)
    shift = vertices[0] - vertices[len(cube()[0])]
    vertices[len(cube()[0]) :] += shift
    faces[faces == len(cube()[0])] = 0
    return vertices, faces


@with_each(
    ("body", "cuts"),
    [
        (cube(), False),
        (ball(2), False),
        (inverted(ball(2)), False),
        (torus(1.0), False),
        (torus(0.305), False),
        (torus(0.297), True),
        (inverted(torus(0.297)), True),
        (torus(0.2), True),
        (at_a_corner(cube(0.5)), True),  # within the cube, in the planes of three of its faces
        (at_a_corner(sized(cube(), -0.5)), False),  # beside it
        (together(torus(1.0), cube(0.1, (5.0, 0.0, 0.0))), False),
        (together(cube(0.1, (5.0, 0.0, 0.0)), torus(0.297)), True),
    ],
)
@with_each("place", [(1.0, 0.0), (1e-3, 0.0), (1.0, 40.0)])
def test_a_surface_that_cuts_itself_is_found_however_little_it_does(
    body: Triangles, cuts: bool, place: tuple[float, float]
) -> None:
    vertices, faces = turned(body, np.random.default_rng(3), *place)
    assert cuts_itself(vertices, faces) == cuts


def test_a_surface_that_cuts_itself_is_a_shell() -> None:
    """Which side a place is on is not known: nothing is called inside, and the surface is kept clear of."""
    vertices, faces = torus(0.297)
    mesh = sn.Mesh(vertices, faces, name="ring")
    assert not mesh.watertight
    assert mesh.defects == ("its surface cuts through itself, so it is used as a shell and not as a solid",)
    assert sn.Mesh(*torus(0.305)).watertight
    refused("inside", lambda: sn.Mesh(vertices, faces, inside=True), "cuts through itself")
    within = sn.Scene([mesh]).distance([(0.297, 0.0, 0.0)])
    assert within == pytest.approx(measure(mesh, np.array([[0.297, 0.0, 0.0]])))
    assert (within > 0.2).all()
