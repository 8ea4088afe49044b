"""How the error falls with the iterations of a method."""

from dataclasses import replace
from typing import Any

import numpy as np

from sinuous.checks import Floats
from sinuous.methods import registry
from sinuous.solution.solution import Solution
from sinuous.solving.solver import SolvesAgain

MOST = 400
"""Iterations that are shown."""


def counts_iterations(solution: Solution) -> bool:
    """Whether its method can be stopped after any number of iterations, and it is known with which options it ran."""
    return isinstance(solution._resolver, SolvesAgain) and hasattr(_options(solution._resolver), "iterations")


def errors(solution: Solution) -> tuple[Floats, Floats]:
    """Errors in position and angle (k,) of the best configuration after 1, 2, ... iterations from the first start.

    The problem is solved again and again, each time with one iteration more; NaN where no target asks for it.
    """
    again = solution._resolver
    assert isinstance(again, SolvesAgain)
    options, given = _options(again), solution._given.reshape(-1, *solution.q.shape)
    found: list[tuple[float, float]] = []
    for count in range(1, min(options.iterations, MOST) + 1):
        method = replace(options, iterations=count)
        one = again.solve(solution.problem, given[0] if len(given) else None, method=method, max_starts=1, routes=False)
        found.append((_known(one.position_error), _known(one.angle_error)))
        if one.solved or one.iterations < count:
            break
    position, angle = np.array(found).T
    return position, angle


def _options(again: SolvesAgain) -> Any:
    """Return the options of the method, also where it was given by its name."""
    method = again.options.method
    return registry.options_class(method)() if isinstance(method, str) else method


def _known(error: float | None) -> float:
    return np.nan if error is None else error
