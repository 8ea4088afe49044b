"""Checks at the surface: what is right comes back clean, what is wrong is refused in one line."""

import itertools
import math
import pickle
from typing import Any

import numpy as np
import pytest

from sinuous.base import checks
from sinuous.base.errors import InputError
from tests.helpers import NOT_NUMBERS, NOT_VECTORS, refused, refused_each, with_each


@with_each("value", NOT_NUMBERS)
def test_what_is_no_number_is_refused(value: Any) -> None:
    error = refused("key", lambda: checks.number("key", value), "finite number")
    assert error.value is value


@with_each("value", [0, 4, 2.0, True, "2", None, math.nan, 10**9, np.float64(2.0), 10**5000])
def test_what_is_no_count_is_refused(value: Any) -> None:
    refused("key", lambda: checks.integer("key", value, 1, 3), "1 to 3")


@with_each("value", NOT_VECTORS)
def test_what_is_no_vector_is_refused(value: Any) -> None:
    refused("key", lambda: checks.vector("key", value), "expected 3 finite numbers")


def test_arrays_come_back_as_frozen_copies() -> None:
    source = np.array([1, 2, 3])
    result = checks.vector("key", source)
    source[0] = 9
    np.testing.assert_array_equal(result, [1.0, 2.0, 3.0])
    assert result.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        result[0] = 5.0


@pytest.mark.parametrize("scale", [1.0, 1e-300, 5e-324, 1e300])
def test_directions_of_any_length_become_unit_vectors(scale: float) -> None:
    result = checks.direction("key", np.array([0.0, 3.0, -4.0]) * scale if scale != 5e-324 else [0.0, scale, 0.0])
    assert np.linalg.norm(result) == pytest.approx(1.0, abs=1e-15)
    assert not result.flags.writeable
    if scale != 5e-324:
        np.testing.assert_allclose(result, [0.0, 0.6, -0.8], atol=1e-15)


def test_intervals() -> None:
    assert checks.interval("key", 2) == (2.0, 2.0)
    for pair in ((1, 2), [1.0, 2.0], np.array([1, 2]), iter((1, 2))):
        assert checks.interval("key", pair) == (1.0, 2.0)
    assert checks.interval("key", (2.0, 2.0)) == (2.0, 2.0)


@with_each(
    "value",
    [
        "12",
        b"12",
        {1: 2, 3: 4},
        None,
        True,
        (),
        (1,),
        (1, 2, 3),
        [[1, 2], [3, 4]],
        range(10**9),
        itertools.count(),
        np.array(3.0),
    ],
)
def test_what_is_no_interval_is_refused_at_once(value: Any) -> None:
    with pytest.raises(InputError, match=r"^key"):
        checks.interval("key", value)


def test_intervals_name_the_end_that_is_wrong() -> None:
    refused("key", lambda: checks.interval("key", (2.0, 1.0)), "low <= high")
    refused("key[0]", lambda: checks.interval("key", (-1.0, 1.0), low=0.0), "at least 0")
    refused("key[1]", lambda: checks.interval("key", (1.0, math.inf)))
    refused("key[1]", lambda: checks.interval("key", (0.0, True)))
    refused("key", lambda: checks.interval("key", -1.0, low=0.0))


def test_outer_keys_are_put_in_front() -> None:
    def nested() -> None:
        with checks.inside("robot"), checks.inside("segments[2]"):
            checks.number("length", "long")

    refused("robot.segments[2].length", nested)

    def indexed() -> None:
        with checks.inside("length"):
            checks.number("[1]", "long")

    refused("length[1]", indexed)


def test_long_values_are_shortened_to_one_line() -> None:
    refused_each(
        "key",
        ("x" * 10**6, "a\nb", list(range(10**5)), np.zeros((100, 100)), {i: i for i in range(1000)}, 10**4000),
        lambda value: checks.vector("key", value),
    )


def test_errors_are_value_errors_and_survive_pickling() -> None:
    error = refused("key", lambda: checks.number("key", "one"), "'one'")
    assert isinstance(error, ValueError)
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error)
    assert (again.key, again.value, again.expected) == ("key", "one", "a finite number")
