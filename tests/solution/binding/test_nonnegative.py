"""Nonnegative least squares: what is best is known by its residual, whichever of two methods has found it."""

import numpy as np
import pytest
import scipy.optimize

from sinuous.solution.binding.nonnegative import nonnegative_least_squares
from tests.helpers import Floats


def optimal(system: Floats, wanted: Floats, x: Floats, slack: float) -> None:
    """Karush, Kuhn and Tucker: the residual pulls no coefficient up, and none down that is above zero."""
    pull = system.T @ (wanted - system @ x)
    assert np.all(x >= 0.0)
    assert np.all(pull <= slack)
    np.testing.assert_allclose(pull * x, 0.0, atol=slack)


@pytest.mark.parametrize("seed", range(10))
def test_the_residual_balances(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system, wanted = rng.normal(size=(7, 12)), rng.normal(size=7)
    optimal(system, wanted, nonnegative_least_squares(system, wanted), 1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_what_goes_round_in_circles_is_solved_otherwise(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    def stuck(system: Floats, wanted: Floats) -> tuple[Floats, float]:
        raise RuntimeError("Maximum number of iterations reached.")

    monkeypatch.setattr(scipy.optimize, "nnls", stuck)
    rng = np.random.default_rng(seed)
    system, wanted = rng.normal(size=(12, 7)), rng.normal(size=12)
    system[:, 3] = system[:, 2]
    optimal(system, wanted, nonnegative_least_squares(system, wanted), 1e-5)
