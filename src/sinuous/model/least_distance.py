"""The point nearest to another one within linear bounds (Lawson & Hanson 1974, chapter 23)."""

import numpy as np

from sinuous.base.checks import Floats

APART = 1e-9
"""What is left of the dual problem, whose right side has length 1, below which the bounds contradict each other."""


def least_distance(root: Floats, free: Floats, weights: Floats, low: Floats) -> tuple[Floats, Floats] | None:
    """Return the y (n,) nearest to `free` (n,) with `weights y >= low`, and multipliers (m,); `None`: there is none.

    Distances are those of the metric `root root'`, `root` (n, n) lower triangular, or (0, 0) for the identity; weights
    (m, n), low (m,).
    """
    sizes = np.maximum(np.linalg.norm(weights, axis=1), 1e-300)
    rows = weights / sizes[:, None]
    lack = low / sizes - rows @ free
    if (lack <= 0.0).all():
        return free, np.zeros(len(low))
    unit = float(np.abs(lack).max())
    system = np.concatenate([np.linalg.solve(root, rows.T) if len(root) else rows.T, lack[None] / unit])
    wanted = np.zeros(len(system))
    wanted[-1] = 1.0
    multipliers = nonnegative_least_squares(system, wanted)
    rest = system @ multipliers - wanted
    if np.linalg.norm(rest) < APART or rest[-1] >= 0.0:
        return None
    step: Floats = -unit * rest[:-1] / rest[-1]
    return free + (np.linalg.solve(root.T, step) if len(root) else step), multipliers


def nonnegative_least_squares(system: Floats, wanted: Floats) -> Floats:
    """Return x (k,) >= 0 with the least `|system x - wanted|`, for `system` (m, k) and `wanted` (m,)."""
    from scipy.optimize import lsq_linear, nnls  # noqa: PLC0415

    try:
        result: Floats = nnls(system, wanted)[0]
    except RuntimeError:
        # Columns that are equal but for rounding can let the active set go round in circles; this one cannot.
        result = lsq_linear(system, wanted, bounds=(0.0, np.inf)).x
    return result
