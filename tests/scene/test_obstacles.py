"""Obstacles as nouns: their distances where these are known by hand, what they keep, and bad input."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.primitives import KINDS as JUDGED
from sinuous.measures.obstacles import measure
from sinuous.scene.obstacles import PRIMITIVES, Box, Capsule, Cylinder, HalfSpace, Primitive, Sphere, rows_of
from sinuous.view.display.surfaces import obstacle_surface
from sinuous.view.page.edits import KINDS, make_obstacle
from tests.helpers import NOT_NUMBERS, NOT_VECTORS, refused, refused_each, with_each
from tests.scene.shapes import EACH_KIND
from tests.scene.test_conformance import FIELDS

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


def test_every_exact_kind_is_known_to_files_pages_pictures_measures_judges_and_laws(tmp_path: Path) -> None:
    own = {kind for kind in Primitive.__subclasses__() if kind.__module__ == Primitive.__module__}
    assert own == set(PRIMITIVES.values()) == set(JUDGED)
    assert list(PRIMITIVES) == list(KINDS)  # what can be made by hand
    assert own <= {type(make()) for make in EACH_KIND.values()}
    assert own <= {type(make().obstacle) for make in FIELDS.values()}
    keys = (Path(__file__).parents[2] / "docs" / "format.md").read_text(encoding="utf-8")
    for name, kind in PRIMITIVES.items():
        made = make_obstacle(name, np.ones(3), 0.5)
        assert type(made) is kind is getattr(sn, kind.__name__)
        sn.Scene([made]).save(tmp_path / "scene.yaml")
        assert sn.load(tmp_path / "scene.yaml").equals(sn.Scene([made]))
        assert np.isfinite(measure(made, np.zeros((1, 3)))).all()
        assert len(obstacle_surface(made, np.zeros(3), 2.0, 8).vertices) > 0
        assert f"`{name}`" in keys


class Unmeasured(Sphere):
    """A primitive of a kind that kernels know no distance of."""

    _code = -1


@pytest.mark.parametrize("inside", [False, True])
def test_nothing_is_clear_of_a_primitive_without_a_distance(inside: bool) -> None:
    scene = sn.Scene([Unmeasured((0.0, 0.0, 0.0), 9.0 if inside else 0.1, inside=inside)])
    assert scene.distance([5.0, 0.0, 0.0]) == -np.inf


def test_rows_of_many_obstacles_are_those_of_each() -> None:
    rng = np.random.default_rng(9)
    obstacles: list[Primitive] = [
        HalfSpace((0.0, 0.0, 1.0), (1.0, 0.0, 2.0)),
        Sphere((1.0, 2.0, 3.0), 2.0, inside=True),
    ]
    for axis in (*np.eye(3), *-np.eye(3), *rng.normal(size=(5, 3)), np.array([1e-120, 0.0, -1.0])):
        start = rng.normal(size=3)
        obstacles += [Capsule(start, start + axis, 0.3), Cylinder(start, start + axis, 0.2, inside=bool(axis[0] > 0.0))]
        obstacles += [Box(start, (1.0, 2.0, 3.0), rng.normal(size=4)), Sphere(start, 0.5), Capsule(start, start, 0.1)]
    together = rows_of(obstacles)
    np.testing.assert_allclose(together, [own.row for own in obstacles], rtol=1e-14, atol=1e-15)
