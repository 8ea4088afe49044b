"""Derivatives in one direction, where an answer has a kink: a quadratic program with the rows that are active."""

from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.solution.at_rest import nonnegative_least_squares

RANK = 1e-10
"""Singular value, relative to the largest, below which rows depend on each other."""

INCOMPATIBLE = 1e-9
"""Remainder of a least-distance program, whose right side has length 1, from which on nothing satisfies it."""


class Kept(NamedTuple):
    """What a small motion x (c,) has to do.

    Attributes
    ----------
    equal : ndarray (e, c)
        Rows whose products with x are given.
    least : ndarray (l, c)
        Rows whose products with x are bounded from below.
    hessian : ndarray (c, c) or None
        Of what is least among all such motions, beside `pull`; `None` for the identity.
    """

    equal: Floats
    least: Floats
    hessian: Floats | None


def least_motion(kept: Kept, values: Floats, bounds: Floats, pull: Floats) -> Floats:
    """Return the x (c,) with the least `x' H x / 2 + pull . x` that keeps rows; NaN where none does.

    `values` (e,) and `bounds` (l,) are those of `equal` and `least`. Least-distance programming in what the equations
    leave free (Lawson & Hanson 1974, chapter 23).
    """
    count = kept.equal.shape[1]
    _, sizes, directions = np.linalg.svd(kept.equal)
    rank = int((sizes > RANK * max(1.0, sizes.max(initial=0.0))).sum())
    free = directions[rank:].T
    begin = np.linalg.lstsq(kept.equal, values, rcond=RANK)[0] if len(kept.equal) else np.zeros(count)
    if np.abs(kept.equal @ begin - values).max(initial=0.0) > INCOMPATIBLE * (1.0 + np.abs(values).max(initial=0.0)):
        return np.full(count, np.nan)
    slope = free.T @ (pull + (begin if kept.hessian is None else kept.hessian @ begin))
    if kept.hessian is None:
        root = np.eye(free.shape[1])
    else:
        try:
            root = np.linalg.cholesky(free.T @ kept.hessian @ free)
        except np.linalg.LinAlgError:
            return np.full(count, np.nan)
    best: Floats = begin - free @ np.linalg.solve(root.T, np.linalg.solve(root, slope))
    rows = np.linalg.solve(root, free.T @ kept.least.T).T
    missing = bounds - kept.least @ best
    if missing.max(initial=0.0) <= 0.0:
        return best
    # The least w with rows w >= missing, in units in which the largest of these is 1.
    unit = float(np.abs(missing).max())
    system = np.vstack([rows.T, missing / unit])
    wanted = np.zeros(len(system))
    wanted[-1] = 1.0
    left = system @ nonnegative_least_squares(system, wanted) - wanted
    if abs(left[-1]) <= INCOMPATIBLE:
        return np.full(count, np.nan)
    shift = -unit * left[:-1] / left[-1]
    result: Floats = best + free @ np.linalg.solve(root.T, shift)
    return result
