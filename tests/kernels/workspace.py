"""Workspace of a solve, laid out by the kernels."""

import numpy as np
from numpy.typing import NDArray

from sinuous.kernels.clock import CLOCK_SIZE, DEADLINE
from sinuous.kernels.fields.distances import number_of
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.states import State, Work, carve, pick, workspace_size
from tests.helpers import Floats

NEVER = 2**62


def make_clock(deadline: int = NEVER) -> NDArray[np.int64]:
    """A clock with this deadline, in nanoseconds: 0 is long past."""
    clock = np.zeros(CLOCK_SIZE, np.int64)
    clock[DEADLINE] = deadline
    return clock


def make_workspace(problem: Problem, deadline: int = NEVER) -> tuple[State, Work]:
    """States of a solve, with one more axis in front, and scratch."""
    sizes = len(problem.limits), len(problem.actuation), number_of(problem.scene), len(problem.targets)
    states, work = carve(np.zeros(workspace_size(*sizes)), problem)
    work.clock[DEADLINE] = deadline
    return states, work


def put(states: State, i: int, q: Floats) -> State:
    """Put a configuration into state number `i`, and return that state."""
    states.q[i] = q
    return pick(states, i)
