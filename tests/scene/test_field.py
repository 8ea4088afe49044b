"""Fields: a function is sampled where it was said, and only a distance is accepted."""

from typing import Any

import numpy as np

from sinuous.scene.grids import MOST, Field
from tests.cases import with_each
from tests.helpers import NOT_NUMBERS, NOT_VECTORS, Floats, refused, refused_each

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
