"""Equilibria of coordinates that resist and of lines that pull at them.

Energies are quadratic, so lines that only pull make a convex, piecewise quadratic problem: its minimum is found by a
semismooth Newton method (Qi & Sun 1993) with an exact line search, in a few steps.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats

STEPS = 100
"""Most Newton steps of an equilibrium; a handful is usual."""

TOGETHER = 200_000
"""Numbers of the matrices that are solved at once; more rows go in several parts."""


class Springs(NamedTuple):
    """What an equilibrium balances: coordinates that resist, and lines that pull at them.

    The energy is `sum s/2 (x - rest)^2 + sum k/2 e^2`, with the elongation `e = pulled - arms . x` of every line; of a
    line that is one-sided only where `e > 0`.

    Attributes
    ----------
    resistance : ndarray (c,) or (N, c)
        `s` of the coordinates, at least 0.
    rest : ndarray (c,)
    arms : ndarray (m, c)
    stiffness : ndarray (m,)
        `k` of the lines.
    one_sided : ndarray of bool (m,)
    """

    resistance: Floats
    rest: Floats
    arms: Floats
    stiffness: Floats
    one_sided: NDArray[np.bool_]

    def pulls(self, elongation: Floats) -> NDArray[np.bool_]:
        """Which lines (N, m) transmit a force at these elongations (N, m)."""
        return ~self.one_sided | (elongation > 0.0)

    def hessian(self, pulls: NDArray[np.bool_]) -> Floats:
        """Second derivative (N, c, c) of the energy while these lines (N, m) pull."""
        weighted = (pulls * self.stiffness)[:, :, None] * self.arms
        result: Floats = np.matmul(self.arms.T, weighted)
        diagonal = np.arange(self.arms.shape[1])
        result[:, diagonal, diagonal] += self.resistance
        return result


def equilibrium(springs: Springs, pulled: Floats) -> Floats:
    """Coordinates (N, c) of least energy, where lines are pulled by (N, m).

    The energy must be strictly convex: coordinates resist, or two-sided lines hold them.
    """
    count, c = len(pulled), len(springs.rest)
    out = np.empty((count, c))
    part = max(1, TOGETHER // max(1, c * c + len(springs.arms) ** 2))
    for first in range(0, count, part):
        rows = slice(first, first + part)
        own = springs
        if springs.resistance.ndim == 2:
            own = springs._replace(resistance=springs.resistance[rows])
        out[rows] = _equilibrium(own, pulled[rows])
    return out


def _equilibrium(springs: Springs, pulled: Floats) -> Floats:
    x = np.tile(springs.rest, (len(pulled), 1))
    own, goal, left = springs, pulled, np.arange(len(pulled))
    for _ in range(STEPS):
        now = x[left]
        elongation = goal - now @ own.arms.T
        pulls = own.pulls(elongation)
        slope = own.resistance * (now - own.rest) - (pulls * own.stiffness * elongation) @ own.arms
        step = -np.asarray(np.linalg.solve(own.hessian(pulls), slope[..., None])[..., 0], np.float64)
        change = step @ own.arms.T
        done = (own.pulls(elongation - change) == pulls).all(axis=1)
        share = np.where(done, 1.0, _best_share(own, now, step, elongation, change))
        x[left] = now + share[:, None] * step
        if done.all():
            break
        left, goal = left[~done], goal[~done]
        if own.resistance.ndim == 2:
            own = own._replace(resistance=own.resistance[~done])
    return x


def _best_share(springs: Springs, x: Floats, step: Floats, elongation: Floats, change: Floats) -> Floats:
    """The share (N,) of a step at which the energy along it is least: its slope is piecewise linear, and increases."""
    bends = np.where(change != 0.0, elongation / np.where(change != 0.0, change, 1.0), 0.0)
    kinks = np.sort(np.where(springs.one_sided & (bends > 0.0), bends, 0.0), axis=1)

    def slopes(shares: Floats) -> Floats:
        there = elongation[:, None, :] - shares[:, :, None] * change[:, None, :]
        pulled = np.einsum("nkm,nm->nk", springs.pulls(there) * springs.stiffness * there, change)
        own = np.einsum("nc,nc->n", springs.resistance * (x - springs.rest), step)
        curve = np.einsum("nc,nc->n", springs.resistance * step, step)
        return own[:, None] + shares * curve[:, None] - pulled

    at = slopes(kinks)
    below = (at <= 0.0).sum(axis=1)
    rows = np.arange(len(x))
    left = np.where(below > 0, kinks[rows, np.maximum(below - 1, 0)], 0.0)
    right = np.where(below < kinks.shape[1], kinks[rows, np.minimum(below, kinks.shape[1] - 1)], left + 1.0)
    ends = np.stack([left, right], axis=1)
    low, high = slopes(ends).T
    return left - low * (right - left) / np.where(high != low, high - low, 1.0)
