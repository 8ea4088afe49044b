"""Multipliers of constraints: nonnegative least squares, against SciPy's."""

import numpy as np
import pytest
from scipy.optimize import nnls

from sinuous.kernels.velocity.active_set import activate, most_violated
from sinuous.kernels.velocity.layout import CONSTRAINT_VALUE, CONSTRAINT_WIDTH, MULTIPLIER, WorkingSet


def working_set(system: np.ndarray, values: np.ndarray) -> WorkingSet:
    """Constraints that move each other so (r, r), and have these values (r,)."""
    r = len(values)
    about = np.zeros((r, CONSTRAINT_WIDTH))
    about[:, CONSTRAINT_VALUE] = values
    none = np.zeros((r, 3))
    active, listed = np.zeros((2, r), np.int64)
    return WorkingSet(none, none, about, system, np.zeros((r, r + 1)), active, listed, np.zeros((1, 3)), none)


@pytest.mark.parametrize("seed", range(10))
def test_multipliers_are_those_of_nonnegative_least_squares(seed: int) -> None:
    rng = np.random.default_rng(seed)
    r = int(rng.integers(1, 12))
    weights = rng.normal(size=(r, 8))
    system, values = weights @ weights.T + 1e-6 * np.eye(r), rng.normal(size=r)
    working = working_set(system, values)
    for _ in range(100):
        constraint, missing = most_violated(working, r)
        if missing <= 1e-12:
            break
        activate(working, r, constraint)
    factor = np.linalg.cholesky(system)
    expected, _ = nnls(factor.T, np.linalg.solve(factor, values))
    np.testing.assert_allclose(working.about[:, MULTIPLIER], expected, atol=1e-6 * max(1.0, np.abs(expected).max()))
    assert (working.about[:, MULTIPLIER] >= 0.0).all()
