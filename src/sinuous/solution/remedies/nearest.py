"""The least change of a target that is enough: by search, because the border of what can be reached has no formula."""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import numpy as np

from sinuous.checks import Floats
from sinuous.problem.problem import Problem
from sinuous.solution.remedies.trials import FINE, Trials

if TYPE_CHECKING:
    from sinuous.solution.solution import Solution

ASIDE = (0.5, 0.25, 0.12, 0.06)
"""Angles (rad) by which other changes are tried about the best."""

SMALLER = 0.97
"""Size of a change that is tried aside, relative to the best."""

FARTHER = (1.0, 1.02, 1.2, 1.5, 2.0, 3.0)
"""Sizes of the first change that are tried, until one works."""

Vary = Callable[[Floats], Problem]
"""Makes a problem whose target is changed by a vector (3,)."""

Found = tuple[Floats, "Solution"]


def nearest(
    trials: Trials, vary: Vary, firsts: Iterable[Floats], least: float, plane: Floats | None = None
) -> Found | None:
    """Find a small change with which the problem is solved, beginning with the first of several that works.

    The change is made smaller as long as that works; then smaller ones aside of it are tried, with ever smaller angles
    between (a pattern search).

    Parameters
    ----------
    trials : Trials
    vary : callable
    firsts : iterable of ndarray (3,)
        Changes that may do; those that are zero are passed over.
    least : float
        Size of a change that is none: the search ends there.
    plane : ndarray (3,), optional
        Normal of the plane that all changes lie in.

    Returns
    -------
    (ndarray (3,), Solution) or None
    """
    tried = (_begin(trials, vary, first) for first in firsts if first.any())
    best = next((found for found in tried if found is not None), None)
    if best is None:
        return None
    best = _shorten(trials, vary, best, least)
    for angle in ASIDE:
        better = True
        while better and float(np.linalg.norm(best[0])) > least and trials.may_refine():
            better = False
            for direction in _aside(best[0], plane):
                turned = np.cos(angle) * best[0] / np.linalg.norm(best[0]) + np.sin(angle) * direction
                change = SMALLER * float(np.linalg.norm(best[0])) * turned
                found = trials.quick(vary(change), best[1].q)
                if found is not None:
                    best, better = _shorten(trials, vary, (change, found), least), True
                    break
    return best


def _begin(trials: Trials, vary: Vary, first: Floats) -> Found | None:
    for factor in FARTHER:
        found = trials.quick(vary(factor * first))
        if found is not None:
            return factor * first, found
    return None


def _shorten(trials: Trials, vary: Vary, best: Found, least: float) -> Found:
    """Make a change smaller, in its direction, as long as that works: in steps that grow, then halving."""
    whole, low, high, step = best[0], 0.0, 1.0, FINE
    size = float(np.linalg.norm(whole))
    while high - low > FINE * high and high * size > least and trials.may_refine():
        middle = high - min(step, 0.5 * (high - low))
        found = trials.quick(vary(middle * whole), best[1].q)
        if found is None:
            low, step = middle, 1.0
        else:
            high, best, step = middle, (middle * whole, found), 2.0 * step
    return best


def _aside(change: Floats, plane: Floats | None) -> list[Floats]:
    """Unit vectors across a change, which are within the plane of this normal."""
    along = change / np.linalg.norm(change)
    if plane is not None:
        across = np.cross(plane, along)
        return [across, -across]
    first = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    first /= np.linalg.norm(first)
    second = np.cross(along, first)
    return [first, -first, second, -second]
