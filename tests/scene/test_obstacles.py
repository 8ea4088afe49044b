"""Obstacles as nouns: their distances where these are known by hand, what they keep, and bad input."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

from sinuous.scene.grids import Grid
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Sphere
from sinuous.scene.point_cloud import PointCloud
from sinuous.scene.scene import Scene
from tests.cases import with_each
from tests.helpers import NOT_NUMBERS, NOT_VECTORS, random_rotation, refused, refused_each
from tests.scene.shapes import cube

QUARTER_ABOUT_Z = (math.sqrt(0.5), 0, 0, math.sqrt(0.5))


@with_each(
    ("obstacle", "point", "expected"),
    [
        (Sphere((1, 0, 0), 2), (4, 0, 0), 1.0),
        (Sphere((1, 0, 0), 2), (1, 0, 0), -2.0),
        (Sphere((1, 0, 0), 2, inside=True), (1, 0, 0), 2.0),
        (Box((0, 0, 0), (2, 4, 6)), (4, 6, 3), 5.0),
        (Box((0, 0, 0), (2, 4, 6)), (0.5, 0, 0), -0.5),
        (Box((0, 0, 0), (2, 4, 6), QUARTER_ABOUT_Z), (3, 0, 0), 1.0),
        (Box((0, 0, 0), (2, 4, 6), inside=True), (0, 0, 5), -2.0),
        (Capsule((0, 0, 0), (0, 3, 0), 1), (2, 1, 0), 1.0),
        (Capsule((0, 0, 0), (0, 3, 0), 1), (0, 5, 0), 1.0),
        (Capsule((0, 0, 0), (0, 3, 0), 1), (0, 1, 0), -1.0),
        (Cylinder((0, 0, 0), (0, 3, 0), 1), (0, 5, 0.5), 2.0),
        (Cylinder((0, 0, 0), (0, 3, 0), 1), (0, 6, 5), 5.0),
        (Cylinder((0, 0, 0), (0, 3, 0), 1), (0, 2.75, 0), -0.25),
        (Cylinder((0, 0, 0), (0, 3, 0), 1, inside=True), (0, 1.5, 0.9), 0.1),
        (HalfSpace((0, 0, 2), (0, 0, 5)), (7, 7, 3), 1.0),
        (HalfSpace((0, 0, 2), (0, 0, -5)), (7, 7, 3), -1.0),
    ],
)
def test_known_distances(obstacle: Obstacle, point: Any, expected: float) -> None:
    assert float(Scene([obstacle]).distance(point)) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("seed", range(3))
def test_a_capsule_without_length_is_a_sphere(seed: int) -> None:
    rng = np.random.default_rng(seed)
    center, points = rng.normal(size=3), rng.normal(size=(50, 3))
    capsule, sphere = Scene([Capsule(center, center, 0.7)]), Scene([Sphere(center, 0.7)])
    np.testing.assert_allclose(capsule.distance(points), sphere.distance(points), atol=1e-15)
    np.testing.assert_allclose(capsule.gradient(points), sphere.gradient(points), atol=1e-15)


@pytest.mark.parametrize("kind", [Capsule, Cylinder])
def test_ends_may_be_swapped(kind: Any) -> None:
    rng = np.random.default_rng(3)
    start, end, points = rng.normal(size=3), rng.normal(size=3), rng.normal(size=(50, 3))
    one, other = Scene([kind(start, end, 0.3)]), Scene([kind(end, start, 0.3)])
    np.testing.assert_allclose(one.distance(points), other.distance(points), atol=1e-14)


def test_scenes_move_with_their_obstacles() -> None:
    rng = np.random.default_rng(4)
    turn, move = random_rotation(rng), rng.normal(size=3)
    a, b = rng.normal(size=(2, 3))
    points = 2.0 * rng.normal(size=(200, 3))

    def there(x: Any) -> Any:
        return np.asarray(x) @ turn.T + move

    pairs: list[tuple[Obstacle, Obstacle]] = [
        (Sphere(a, 0.5), Sphere(there(a), 0.5)),
        (Box(a, (1, 2, 3)), Box(there(a), (1, 2, 3), turn)),
        (Capsule(a, b, 0.5), Capsule(there(a), there(b), 0.5)),
        (Cylinder(a, b, 0.5), Cylinder(there(a), there(b), 0.5)),
        (HalfSpace(a, b), HalfSpace(there(a), turn @ b)),
    ]
    for still, moved in pairs:
        one, other = Scene([still]), Scene([moved])
        np.testing.assert_allclose(other.distance(there(points)), one.distance(points), atol=1e-13)
        smooth = abs(np.linalg.norm(other.gradient(there(points)) - one.gradient(points) @ turn.T, axis=1)) < 1e-9
        assert smooth.mean() > 0.98  # equal but for points that sit on a kink


def every() -> list[Obstacle]:
    return [
        Sphere((0, 0, 0), 1, name="ball"),
        Box((0, 0, 0), (1, 1, 1), name="box"),
        Capsule((0, 0, 0), (0, 0, 1), 1, name="pill"),
        Cylinder((0, 0, 0), (0, 0, 1), 1, name="can"),
        HalfSpace((0, 0, 0), (0, 0, 1), name="floor"),
    ]


def test_obstacles_are_frozen() -> None:
    for obstacle in every():
        with pytest.raises(AttributeError):
            obstacle.name = "other"  # type: ignore[misc]
        for value in vars(obstacle).values():
            if isinstance(value, np.ndarray):
                assert not value.flags.writeable, obstacle


def test_kinds_are_those_of_problem_files() -> None:
    assert [o.kind for o in every()] == ["sphere", "box", "capsule", "cylinder", "half_space"]
    assert Mesh(*cube()).kind == "mesh"
    assert PointCloud([[0, 0, 0]], 1).kind == "points"
    assert Grid(np.ones((2, 2, 2), bool), (0, 0, 0), 1).kind == "grid"


def test_names() -> None:
    for obstacle in every():
        other = obstacle.named("other")
        assert other.name == "other"
        assert type(other) is type(obstacle)
        assert {key: value for key, value in vars(other).items() if key != "name"} == {
            key: value for key, value in vars(obstacle).items() if key != "name"
        }
    assert every()[0].named(None).name is None
    assert [o.name for o in every()] == ["ball", "box", "pill", "can", "floor"]
    assert Sphere((0, 0, 0), 1).name is None
    refused_each("name", ("", 3, True, b"ball"), lambda name: Sphere((0, 0, 0), 1, name=name))


VECTORS: list[tuple[str, Callable[[Any], Any]]] = [
    ("center", lambda v: Sphere(v, 1)),
    ("center", lambda v: Box(v, (1, 1, 1))),
    ("size", lambda v: Box((0, 0, 0), v)),
    ("start", lambda v: Capsule(v, (0, 0, 1), 1)),
    ("end", lambda v: Capsule((0, 0, 1), v, 1)),
    ("start", lambda v: Cylinder(v, (0, 0, 1), 1)),
    ("end", lambda v: Cylinder((0, 0, 1), v, 1)),
    ("point", lambda v: HalfSpace(v, (0, 0, 1))),
    ("normal", lambda v: HalfSpace((0, 0, 1), v)),
]
RADII: list[Callable[[Any], Any]] = [
    lambda r: Sphere((0, 0, 0), r),
    lambda r: Capsule((0, 0, 0), (0, 0, 1), r),
    lambda r: Cylinder((0, 0, 0), (0, 0, 1), r),
]


@with_each("value", NOT_VECTORS)
def test_bad_vectors_are_refused(value: Any) -> None:
    for key, make in VECTORS:
        refused(key, partial(make, value))


@with_each("value", [*NOT_NUMBERS, 0.0, -1.0])
def test_bad_radii_are_refused(value: Any) -> None:
    for make in RADII:
        refused("radius", partial(make, value), "greater than 0")


@with_each("value", [1, 0, "true", None, np.array([True])])
def test_inside_is_true_or_false(value: Any) -> None:
    for make in (
        lambda v: Sphere((0, 0, 0), 1, v),
        lambda v: Box((0, 0, 0), (1, 1, 1), inside=v),
        lambda v: Cylinder((0, 0, 0), (0, 0, 1), 1, v),
    ):
        refused("inside", partial(make, value), "true or false")


def test_shapes_without_a_body_are_refused() -> None:
    refused_each("size", ((0, 1, 1), (1, -1, 1)), lambda size: Box((0, 0, 0), size), "greater than 0")
    refused("end", lambda: Cylinder((1, 2, 3), (1, 2, 3), 1), "another point")
    refused("normal", lambda: HalfSpace((0, 0, 0), (0, 0, 0)))
    refused("rotation", lambda: Box((0, 0, 0), (1, 1, 1), np.diag([1, 1, -1])))
    refused("rotation", lambda: Box((0, 0, 0), (1, 1, 1), (0, 0, 0, 0)))
