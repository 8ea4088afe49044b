"""Bounds of errors hold as often as they say."""

import numpy as np

from sinuous.calibration.calibration import bound_of_further


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
