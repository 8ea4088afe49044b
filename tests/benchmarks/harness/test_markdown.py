"""Tables and times as people read them."""

import math

from benchmarks.harness.markdown import span, table
from tests.cases import with_each


def test_columns_are_straight_and_the_first_stands_left() -> None:
    lines = table([["what", "n"], ["a", "1000"], ["longer", "2"]]).splitlines()
    assert lines == ["| what   |    n |", "| ------ | ---: |", "| a      | 1000 |", "| longer |    2 |"]


def test_words_all_stand_left() -> None:
    assert table([["what", "why"], ["a", "because"]], words=True).splitlines()[1:] == [
        "| ---- | ------- |",
        "| a    | because |",
    ]


@with_each(
    ("seconds", "text"),
    [
        (3e-9, "3 ns"),
        (1.234e-6, "1.23 us"),
        (12.34e-6, "12.3 us"),
        (99.96e-6, "100 us"),
        (999.9e-6, "1.00 ms"),
        (0.0172, "17.2 ms"),
        (0.172, "172 ms"),
        (2.5, "2.50 s"),
        (480.0, "480 s"),
        (9.996e-6, "10.0 us"),
        (math.nan, "none"),
    ],
)
def test_times_have_the_unit_that_suits_them(seconds: float, text: str) -> None:
    assert span(seconds) == text
