"""Questions of the places of the benchmark, as sources of starts along routes take them."""

from functools import cache

import numpy as np

from benchmarks.places import Place, make
from sinuous.problem.problem import Problem
from sinuous.solver.attempts import IKQuery
from sinuous.solver.routing.searches import Searches


@cache
def place(family: str, number: int) -> Place:
    """A place of the benchmark, made once."""
    return make(family, number)


def asked(at: Place, several: bool = False, seconds: float = 60.0) -> tuple[Searches, IKQuery]:
    """The question of a place, with so much time left, and what searches for its routes."""
    problem = Problem.prepared(at.robot, at.targets, at.scene.snapshot(), at.tolerance)
    question = IKQuery(problem, np.empty((0, len(at.robot), 3)), lambda: seconds, several)
    return Searches(at.robot, at.scene, at.tolerance), question
