"""Answers that are changed behind the back of the solver, so that a judge has something to find."""

from typing import Any

from sinuous.answer.solution import Solution


def moved(solution: Solution, where: tuple[Any, int], by: float) -> Solution:
    """Return a copy of a solution that claims the same, with other entries of its configuration."""
    q = solution.q.copy()
    q[where] += by
    claimed = solution._outcome._replace(q=q)
    return Solution(solution.problem, claimed, solution.seconds, solution._resolver, solution._given)
