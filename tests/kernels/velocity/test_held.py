"""Forces that push and never pull: nonnegative least squares, against SciPy's."""

import numpy as np
import pytest
from scipy.optimize import nnls

from sinuous.kernels.velocity.held import most_left, push
from sinuous.kernels.velocity.working import FORCE, ROW_WIDTH, VALUE, Held


def held_of(system: np.ndarray, values: np.ndarray) -> Held:
    """Rows that move each other so (r, r), and ask for these values (r,)."""
    r = len(values)
    about = np.zeros((r, ROW_WIDTH))
    about[:, VALUE] = values
    none = np.zeros((r, 3))
    active, pushing = np.zeros((2, r), np.int64)
    return Held(none, none, about, system, np.zeros((r, r + 1)), active, pushing, np.zeros((1, 3)), none)


@pytest.mark.parametrize("seed", range(20))
def test_forces_are_those_of_nonnegative_least_squares(seed: int) -> None:
    rng = np.random.default_rng(seed)
    r = int(rng.integers(1, 12))
    weights = rng.normal(size=(r, 8))
    system, values = weights @ weights.T + 1e-6 * np.eye(r), rng.normal(size=r)
    held = held_of(system, values)
    for _ in range(100):
        row, missing = most_left(held, r)
        if missing <= 1e-12:
            break
        push(held, r, row)
    factor = np.linalg.cholesky(system)
    expected, _ = nnls(factor.T, np.linalg.solve(factor, values))
    np.testing.assert_allclose(held.about[:, FORCE], expected, atol=1e-6 * max(1.0, np.abs(expected).max()))
    assert (held.about[:, FORCE] >= 0.0).all()


def test_two_rows_that_say_the_same_share_the_force() -> None:
    held = held_of(np.array([[1.0, 1.0], [1.0, 1.0]]) + 1e-13 * np.eye(2), np.array([0.5, 0.5]))
    for row in (0, 1):
        push(held, 2, row)
    assert held.about[:, FORCE].sum() == pytest.approx(0.5)
