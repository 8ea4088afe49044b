"""What an answer has to keep while parameters change: its rows, as kernels find them."""

from functools import cached_property
from typing import NamedTuple

import numpy as np

from sinuous.answer.derivatives.parameters import DerivativePlan
from sinuous.base.checks import Floats
from sinuous.kernels.derivative import layout as a
from sinuous.kernels.derivative.query import derive, find_contacts
from sinuous.kernels.packing import scales_of
from sinuous.model.least_distance import least_distance
from sinuous.problem.problem import Problem


def fixed_lengths(plan: DerivativePlan) -> Floats:
    """Motions (3 n, p) of the lengths of segments that cannot stretch, by the parameters that say them."""
    direct = np.zeros((3 * len(plan.robot), plan.columns))
    if plan.asked[a.LENGTHS] >= 0:
        fixed = np.flatnonzero(scales_of(plan.robot.limits)[:, 2] == 0.0)
        direct[3 * fixed + 2, plan.asked[a.LENGTHS] + fixed] = 1.0
    return direct


class KeptRows:
    """The rows of an answer, targets first.

    Attributes
    ----------
    problem : Problem
    plan : DerivativePlan
    answer : ndarray
        As kernels fill it, see `sinuous.kernels.derivative.layout`.
    q : ndarray (n, 3)
        The configuration.
    """

    __slots__ = ("__dict__", "answer", "plan", "problem", "q")

    def __init__(self, problem: Problem, plan: DerivativePlan, answer: Floats, q: Floats) -> None:
        self.problem, self.plan, self.answer, self.q = problem, plan, answer, q

    @classmethod
    def found(cls, problem: Problem, plan: DerivativePlan, q: Floats) -> "KeptRows":
        """Find what `q` (n, 3) keeps, and derive it as the nearest answer."""
        answer = np.empty(plan.answer)
        group = problem.scene._kernel_group if plan.obstacles else None
        own = plan.group, group, plan.settings, problem._rows, plan.asked, plan.lines
        derive(*own, np.array(q), plan.workspace, answer)
        return cls(problem, plan, answer, q)

    @classmethod
    def near(cls, problem: Problem, plan: DerivativePlan, q: Floats, keep: float) -> "KeptRows":
        """Find the places of the body whose gaps to obstacles are at most about `keep`, which gaps count from."""
        answer, workspace = np.empty(plan.answer), np.empty(plan.workspace.size)
        own = plan.group, problem.scene._kernel_group, plan.settings, problem._rows, plan.asked, plan.lines
        find_contacts(*own, q.copy(), keep, workspace, answer)
        return cls(problem, plan, answer, q)

    def at(self, q: Floats) -> "KeptRows":
        """Return those of another configuration, or of a Newton step from there, which meets the targets."""
        found = self.found(self.problem, self.plan, q)
        found.q = self.plan.workspace[: q.size].reshape(q.shape).copy()
        return found

    @property
    def moved(self) -> Floats:
        """Derivatives (3 n, p) of the configuration by all parameters."""
        size = 3 * len(self.plan.robot)
        return self.answer[a.ANSWER_HEADER : a.ANSWER_HEADER + size * self.plan.columns].reshape(size, -1)

    @property
    def targets(self) -> int:
        """How many are those of targets."""
        return int(self.answer[a.TARGET_ROWS])

    @property
    def smooth(self) -> bool:
        """Whether the targets can follow all small changes, and there was room for all rows."""
        return not int(self.answer[a.STATUS]) & (a.SINGULAR | a.TOO_MANY)

    @cached_property
    def _parts(self) -> tuple[Floats, Floats, Floats]:
        count, r, size = int(self.answer[a.ROW_COUNT]), self.plan.rows, 3 * len(self.plan.robot)
        first, found = a.ANSWER_HEADER + size * self.plan.columns, []
        for width in (size, a.ABOUT_WIDTH, self.plan.columns):
            found.append(self.answer[first : first + r * width].reshape(r, width)[:count])
            first += r * width
        return found[0], found[1], found[2]

    @property
    def rows(self) -> Floats:
        """Rows (r, 3 n), of length 1 in the metric."""
        return self._parts[0]

    @property
    def about(self) -> Floats:
        """What is known about them (r, 12)."""
        return self._parts[1]

    @property
    def sides(self) -> Floats:
        """What parameters ask of them (r, p)."""
        return self._parts[2]

    @property
    def missing(self) -> Floats:
        """By how much (r,) rows have to change for targets to be met, and for nothing to be left of limits."""
        left = self.about[:, a.ROW_FACTOR] * self.about[:, a.ROW_SLACK]
        return np.where(self.about[:, a.ROW_KIND] == a.TARGET_ROW, left, -left)


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
