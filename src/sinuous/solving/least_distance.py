"""The point nearest to another one within linear bounds (Lawson & Hanson 1974, chapter 23)."""

import numpy as np

from sinuous.checks import Floats

APART = 1e-9
"""What is left of the dual problem below which the bounds contradict each other."""


def least_distance(root: Floats, free: Floats, weights: Floats, low: Floats) -> tuple[Floats, Floats] | None:
    """Return the y (n,) nearest to `free` (n,) with `weights y >= low`, and multipliers (m,); `None`: there is none.

    Distances are those of the metric `root root'`, `root` (n, n) lower triangular; weights (m, n), low (m,).
    """
    from scipy.optimize import nnls  # noqa: PLC0415

    sizes = np.maximum(np.linalg.norm(weights, axis=1), 1e-300)
    rows = weights / sizes[:, None]
    lack = low / sizes - rows @ free
    if (lack <= 0.0).all():
        return free, np.zeros(len(low))
    unit = float(np.abs(lack).max())
    system = np.concatenate([np.linalg.solve(root, rows.T), lack[None] / unit])
    wanted = np.zeros(len(system))
    wanted[-1] = 1.0
    multipliers, left = nnls(system, wanted, maxiter=30 * len(low))
    rest = system @ multipliers - wanted
    if left < APART or rest[-1] >= 0.0:
        return None
    step: Floats = free + np.linalg.solve(root.T, -unit * rest[:-1] / rest[-1])
    return step, multipliers
