"""Bounds of errors hold as often as they say."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sinuous.studies.calibration.calibration import (
    attainable,
    bound_of,
    bound_of_further,
    bounds_of,
    joined_parts,
    scales_of_points,
    whole_patterns,
)


@pytest.mark.parametrize("rows", [19, 40, 200])
@pytest.mark.parametrize("points", [1, 3, 6])
def test_a_bound_of_some_rows_holds_for_the_others_as_often_as_it_says(rows: int, points: int) -> None:
    """All points of a row together, each with errors of its own size, which go together."""
    random, held = np.random.default_rng(rows + points), []
    sizes = np.arange(1.0, points + 1.0)
    own: Any = SimpleNamespace(
        levers=np.ones(points), labels=("motion",) * rows, places=[SimpleNamespace(segment=k) for k in range(points)]
    )
    scales = scales_of_points(random.normal(size=(500, points, 3)) * sizes[:, None])
    for _ in range(400):
        common = random.lognormal(size=(rows + 100, 1, 1))
        off = common * random.normal(size=(rows + 100, points, 3)) * sizes[:, None]
        bounds = np.broadcast_to(bounds_of(range(points), off[:rows], own, 0.95, scales), points)
        held.append((np.linalg.norm(off[rows:], axis=2) <= bounds).all(axis=1).mean())
    assert 0.93 < np.mean(held) < 0.97


def test_too_few_rows_bound_nothing_at_this_level() -> None:
    errors = np.arange(1.0, 20.0)
    assert bound_of(errors, 0.95) == 19.0
    assert bound_of(errors, 0.5) == 10.0
    assert bound_of(errors[:18], 0.95) == math.inf
    assert bound_of(errors[:9], 0.9) == 9.0
    assert [attainable(n, 0.95) for n in (3, 18, 19, 100)] == pytest.approx([0.75, 18 / 19, 0.95, 0.95])
    for n in (1, 3, 8, 12, 19):
        assert bound_of(errors[:n], attainable(n, 0.95)) == n


def test_patterns_with_too_few_rows_count_together() -> None:
    off = np.arange(40.0)
    labels = ["long"] * 20 + ["a"] * 10 + ["b"] * 10
    assert sorted(map(len, joined_parts(off, labels, 0.95))) == [20, 20]
    assert sorted(map(len, joined_parts(off[:30], labels[:30], 0.95))) == [20, 30]
    assert sorted(map(len, joined_parts(off[:12], ["a"] * 12, 0.95))) == [12]


def test_a_bound_for_further_patterns_holds_as_often_as_it_says() -> None:
    """Patterns differ in size and in how large their errors are; one of each draw was not seen."""
    random, held = np.random.default_rng(3), []
    for _ in range(600):
        scales = random.lognormal(0.0, 0.5, 41)
        parts = [scale * random.exponential(1.0, random.integers(1, 30)) for scale in scales]
        held.append(float((parts[0] <= bound_of_further(parts[1:], 0.95)).mean()))
    assert 0.94 < np.mean(held) < 0.97


def test_few_patterns_bound_nothing() -> None:
    errors = [np.linspace(0.0, 1.0, 50)] * 18
    assert bound_of_further(errors, 0.95) == np.inf
    assert bound_of_further([*errors, errors[0]], 0.95) == 1.0


def test_what_goes_on_from_a_pattern_is_no_pattern_of_its_own() -> None:
    labels = ["a_dir1", "a_dir1_hold", "a_dir10", "b_hold", "b_hold_on_still", "b"]
    assert whole_patterns(labels) == ["a_dir1", "a_dir1", "a_dir10", "b", "b", "b"]
    assert whole_patterns(["b_hold", "rows 1 to 3"]) == ["b_hold", "rows 1 to 3"]
