"""Grids: distances and occupancy, NPZ files, and bad input.

Fields: a function is sampled where it was said, and only a distance is accepted.
"""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sinuous.scene.grids import MOST, Field, Grid
from tests.helpers import NOT_NUMBERS, NOT_VECTORS, Floats, Unpickled, refused, refused_each, with_each

ORIGIN = (-1.0, -2.0, -3.0)
SPACING = 0.5


def distances(kind: Any = np.float64, shape: tuple[int, ...] = (6, 7, 8)) -> Any:
    """Distances to a ball at the origin, on the grid of this file."""
    points = np.array(ORIGIN) + SPACING * np.moveaxis(np.indices(shape), 0, -1)
    return (np.linalg.norm(points, axis=-1) - 0.7).astype(kind)


@pytest.mark.parametrize("kind", [np.float64, np.float32, np.float16])
def test_distances(kind: Any) -> None:
    grid = Grid(distances(kind), ORIGIN, SPACING, name="field")
    assert not grid.occupancy
    assert grid.values.dtype == np.float64
    assert not grid.values.flags.writeable
    np.testing.assert_allclose(grid.values, distances(), rtol=1e-3)
    np.testing.assert_array_equal(grid.origin, ORIGIN)
    assert (grid.spacing, grid.name) == (SPACING, "field")


@pytest.mark.parametrize("kind", [np.bool_, np.uint8, np.int64])
def test_occupancy(kind: Any) -> None:
    occupied = distances() < 0.0
    grid = Grid(occupied.astype(kind), ORIGIN, SPACING)
    assert grid.occupancy
    assert grid.values.dtype == np.bool_
    np.testing.assert_array_equal(grid.values, occupied)
    assert Grid(np.ones((1, 1, 1), bool), ORIGIN, 1).occupancy


@with_each("step", [(1, 0, 0), (0, 0, -1), (1, 1, 0), (1, -1, 1), (-1, 1, 1), (0, 1, -1)])
def test_what_changes_too_fast_is_refused(step: tuple[int, int, int]) -> None:
    """One value is wrong by more than a distance can be to one of its 26 neighbours, if not to the others."""
    far = float(np.linalg.norm(step))
    place = np.array([3, 3, 3])
    values = np.zeros((6, 7, 8))
    for other in np.ndindex(values.shape):
        values[other] = SPACING * np.linalg.norm(place - other)
    fine = Grid(values, ORIGIN, SPACING)
    assert fine.values.min() == 0.0
    values[tuple(place + step)] += 1e-3 * far
    error = refused("values", lambda: Grid(values, ORIGIN, SPACING), "times as fast as a distance can")
    pair = [list(place), list(place + step)]
    assert any(str([int(i) for i in end]) in error.problem for end in pair)
    assert abs(error.value[0] - error.value[1]) > SPACING


def test_a_wrong_unit_is_refused_with_the_number() -> None:
    refused("values", lambda: Grid(1000.0 * distances(), ORIGIN, SPACING), "changes 1000 times as fast", "[")
    refused("values", lambda: Grid(distances(), ORIGIN, 0.5 * SPACING), "changes 2 times as fast")


def test_wrong_values_are_refused() -> None:
    good = distances()
    refused("values", lambda: Grid(good[0], ORIGIN, 1), "shape (7, 8); ")
    refused("values", lambda: Grid(good[None], ORIGIN, 1), "shape (1, 6, 7, 8); ")
    refused("values", lambda: Grid(good[:1], ORIGIN, 1), "at least two points along every axis")
    refused("values", lambda: Grid(np.zeros((0, 3, 3)), ORIGIN, 1), "shape (0, 3, 3); ")
    refused("values", lambda: Grid(3 * np.ones((3, 3, 3), int), ORIGIN, 1), "only 0 and 1", "got 3")
    refused("values", lambda: Grid(-np.ones((3, 3, 3), int), ORIGIN, 1), "got -1")
    refused("values", lambda: Grid("values", ORIGIN, 1))  # type: ignore[arg-type]
    refused("values", lambda: Grid([[[0, 1], [2]]], ORIGIN, 1))
    refused("values", lambda: Grid(good.astype(complex), ORIGIN, 1), "complex128")
    for bad in (np.nan, np.inf):
        wrong = good.copy()
        wrong[1, 2, 3] = bad
        refused("values[1, 2, 3]", partial(Grid, wrong, ORIGIN, SPACING), "a distance")
    refused_each("origin", NOT_VECTORS, lambda value: Grid(good, value, SPACING))
    refused_each("spacing", [*NOT_NUMBERS, 0.0, -1.0], lambda value: Grid(good, ORIGIN, value))


def test_files(tmp_path: Path) -> None:
    file = tmp_path / "grid.npz"
    for values in (distances(np.float32), distances() < 0.0):
        for save in (np.savez, np.savez_compressed):
            save(file, values=values, origin=ORIGIN, spacing=SPACING)
            grid = Grid.load(file, name="mask")
            np.testing.assert_array_equal(grid.values, values)
            np.testing.assert_array_equal(grid.origin, ORIGIN)
            assert (grid.spacing, grid.name) == (SPACING, "mask")
    np.savez(file, values=distances(), origin=ORIGIN, spacing=np.array([SPACING]))
    assert Grid.load(file).spacing == SPACING


def test_wrong_files_are_refused(tmp_path: Path) -> None:
    good: dict[str, Any] = {"values": distances(), "origin": ORIGIN, "spacing": SPACING}
    file = tmp_path / "grid.npz"
    for key, value, words in (
        ("values", None, ("missing; expected ", " values, ", ", got ['origin', 'spacing']")),
        ("spacing", None, ("missing; expected ",)),
        ("spacing", [0.5, 0.5, 0.6], ("expected the same spacing along all axes",)),
        ("spacing", True, (": expected a number greater than 0, got True",)),
        ("values", distances()[0], ("shape (7, 8); expected ",)),
        ("values", 9.0 * distances(), ("changes 9 times as fast",)),
        ("values", np.array([Unpickled()], object), ("cannot be read; expected ", "Object arrays")),
        ("origin", [0, 0], ("expected 3 finite numbers",)),
    ):
        np.savez(file, **{name: each for name, each in (good | {key: value}).items() if each is not None})
        refused(key, lambda: Grid.load(file), *words, file=file)
    refused("file", lambda: Grid.load(tmp_path / "none.npz"), "No such file")
    refused("file", lambda: Grid.load(tmp_path / "grid.npy"), "ends in .npz")
    for content in (b"", b"no archive", b"PK\x03\x04 no archive either"):
        file.write_bytes(content)
        refused("file", lambda: Grid.load(file), "NPZ")


LOW, HIGH = (-1.0, -1.0, -2.0), (1.0, 1.5, 2.0)


def ball(points: Floats) -> Floats:
    return np.asarray(np.linalg.norm(points, axis=-1) - 0.5)


def test_samples_are_the_function_on_a_grid_that_covers_the_box() -> None:
    field = Field(ball, LOW, HIGH, 0.3, name="ball")
    assert field.values.shape == (8, 10, 15)
    reach = field.origin + 0.3 * (np.array(field.values.shape) - 1)
    assert (reach >= np.array(HIGH) - 1e-9).all()
    assert (reach < np.array(HIGH) + 0.3).all()
    for index in ((0, 0, 0), (7, 9, 14), (3, 1, 4)):
        assert field.values[index] == ball(np.array(LOW) + 0.3 * np.array(index))
    assert field.name == "ball"
    assert field.function is ball
    assert not field.values.flags.writeable
    assert Field(ball, LOW, HIGH, 0.25).values.shape == (9, 11, 17)
    assert Field(ball, LOW, HIGH, 9).values.shape == (2, 2, 2)


@with_each(
    ("function", "words"),
    [
        (lambda p: 2.0 * ball(p), "times as fast as a distance can"),
        (lambda p: ball(p)[:-1], "shape ("),
        (lambda p: ball(p)[:, None], "shape ("),
        (lambda p: 1.0, "shape (); "),
        (lambda p: None, "shape (); "),
        (lambda p: ball(p) < 0.0, "shape ("),
        (lambda p: np.where(p[:, 0] > 0.6, np.nan, ball(p)), "at ["),
    ],
)
def test_what_is_no_distance_is_refused(function: Any, words: str) -> None:
    refused("function", lambda: Field(function, LOW, HIGH, 0.3), words)


def test_wrong_boxes_are_refused() -> None:
    refused_each("function", (None, 3.0, "ball", np.zeros((3, 3, 3))), lambda value: Field(value, LOW, HIGH, 0.3))
    refused_each("low", NOT_VECTORS, lambda value: Field(ball, value, HIGH, 0.3))
    refused_each("high", [*NOT_VECTORS, LOW, (2, 2, -2)], lambda value: Field(ball, LOW, value, 0.3))
    refused_each("spacing", [*NOT_NUMBERS, 0.0, -1.0], lambda value: Field(ball, LOW, HIGH, value))
    tiny = (1e-3, 1e-9, 1e-300)
    refused_each("spacing", tiny, lambda value: Field(ball, LOW, HIGH, value), f"at most {MOST} samples")
