"""The nearest point within bounds, beside that of SciPy."""

from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.optimize import LinearConstraint, minimize

from sinuous.answer.least_distance import least_distance
from sinuous.base.checks import Floats


def _energy(free: Floats, square: Floats, y: Floats) -> float:
    return float(0.5 * (y - free) @ square @ (y - free))


def test_it_is_the_one_of_scipy() -> None:
    random = np.random.default_rng(5)
    held = 0
    for _ in range(8):
        half = random.normal(size=(5, 5))
        square: Any = half @ half.T + 0.1 * np.eye(5)
        free, weights, low = random.normal(size=5), random.normal(size=(6, 5)), random.uniform(-1.0, 0.5, 6)
        bounds = LinearConstraint(weights, low)
        oracle: Any = minimize(
            partial(_energy, free, square), np.zeros(5), constraints=bounds, tol=1e-12, method="SLSQP"
        )
        if not oracle.success:
            continue
        found = least_distance(np.linalg.cholesky(square), free, weights, low)
        assert found is not None
        assert found[0] == pytest.approx(oracle.x, abs=1e-4)
        assert (weights @ found[0] >= low - 1e-9).all()
        held += bool(found[1].any())
    assert held >= 3


def test_bounds_that_contradict_each_other_have_none() -> None:
    root, free = np.eye(2), np.zeros(2)
    assert least_distance(root, free, np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([1.0, 0.0])) is None
    kept = least_distance(root, free, np.array([[1.0, 0.0]]), np.array([-1.0]))
    assert kept is not None
    assert kept[0].tolist() == [0.0, 0.0]
