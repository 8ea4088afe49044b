"""Numbers and lists in sentences."""

import numpy as np

from sinuous.base import errors
from tests.cases import with_each


@with_each(
    ("numbers", "count", "text"),
    [
        ([3], 5, "segment 3"),
        ([1, 2], 5, "segments 1 and 2"),
        ([4, 2, 3, 6], 9, "segments 2 to 4 and 6"),
        ([1, 2, 3], 3, "all segments"),
        ([1], 1, "segment 1"),
        ([1, 3, 5], None, "segments 1, 3 and 5"),
    ],
)
def test_segments(numbers: list[int], count: int | None, text: str) -> None:
    assert errors.segments(numbers, count) == text


@with_each(
    ("seconds", "text"),
    [(8.7e-6, "8.7 us"), (87.3e-6, "87.3 us"), (1e-3, "1 ms"), (41.63e-3, "41.6 ms"), (1.0, "1 s"), (11.24, "11.2 s")],
)
def test_times_have_the_unit_that_suits_them(seconds: float, text: str) -> None:
    assert errors.duration(seconds) == text


def test_rounding_up_loses_at_most_a_hundredth() -> None:
    rng = np.random.default_rng(0)
    for value in 10.0 ** rng.uniform(-9, 9, 500):
        up = errors.rounded_up(float(value))
        assert value * (1.0 - 1e-11) <= up <= 1.0101 * value
    assert errors.rounded_up(0.2) == 0.2
