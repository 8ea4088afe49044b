"""Bounds of errors hold as often as they say."""

import numpy as np

from sinuous.studies.calibration.calibration import bound_of_further, whole_patterns


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
