"""Least squares with coefficients that cannot be negative (Lawson & Hanson 1974, chapter 23)."""

import numpy as np

from sinuous.checks import Floats


def nonnegative_least_squares(system: Floats, wanted: Floats) -> Floats:
    """Return x (k,) >= 0 with the least `|system x - wanted|`, for `system` (m, k) and `wanted` (m,)."""
    from scipy.optimize import lsq_linear, nnls  # noqa: PLC0415

    try:
        result: Floats = nnls(system, wanted)[0]
    except RuntimeError:
        # Columns that are equal but for rounding can let the active set go round in circles; this one cannot.
        result = lsq_linear(system, wanted, bounds=(0.0, np.inf)).x
    return result
