"""Derivatives in one direction, where an answer has a kink: a quadratic program with the rows that are active."""

from typing import NamedTuple

import numpy as np

from sinuous.answer.least_distance import least_distance
from sinuous.base.checks import Floats

RANK = 1e-10
"""Singular value, relative to the largest, below which rows depend on each other."""

INCOMPATIBLE = 1e-9
"""By how much equations may be missed, relative to their right sides, or nothing satisfies them."""


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
    leave free.
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
    best: Floats = -np.linalg.solve(root.T, np.linalg.solve(root, slope))
    nearest = least_distance(root, best, kept.least @ free, bounds - kept.least @ begin)
    return np.full(count, np.nan) if nearest is None else begin + free @ nearest[0]
