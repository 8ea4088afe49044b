"""Workspace of a solve as the kernels lay it out, of arrays that Python can see."""

import numpy as np
from numpy.typing import NDArray

from sinuous.kernels.body.contacts import PER_SEGMENT
from sinuous.kernels.body.rows import Rows
from sinuous.kernels.body.self_contacts import MOST_PAIRS
from sinuous.kernels.chain.kinematics import put_frame
from sinuous.kernels.clock import CLOCK_SIZE, DEADLINE
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.states import NORMS, STATES, State, Work, rest_size
from tests.helpers import Floats, mat, vec

NEVER = 2**62


@kernel
def same(what: Array, where: Array) -> None:
    """Copy an array into another, both C-contiguous: `where[:] = what` would own memory, which no kernel does."""
    for i in range(what.size):
        where.flat[i] = what.flat[i]


def make_states(problem: Problem) -> State:
    """States of a solve, with one more axis in front."""
    n, m, c = len(problem.limits), len(problem.scene.table), STATES
    capacity = 6 * len(problem.targets) + len(problem.actuation) + (n * PER_SEGMENT if m else 0)
    rows = Rows(
        np.zeros((c, n + 1), np.int64),
        np.zeros((c, capacity), np.int64),
        np.zeros((c, capacity, 6)),
        np.zeros((c, capacity, 3)),
        np.zeros((c, capacity, 3)),
        np.zeros((c, capacity)),
        np.zeros((c, capacity, 13)),
        np.zeros((c, capacity)),
    )
    shapes = np.zeros((c, n, 3)), np.zeros((c, n + 1, 12)), np.zeros((c, n, 18))
    states = State(*shapes, rows, np.zeros((c, NORMS + MOST_PAIRS * (1 + 3 * n))))
    base = problem.base[0]
    for i in range(c):
        put_frame(states.frames[i], 0, mat(base[:9].reshape(3, 3)), vec(base[9:]))
    return states


def state_of(states: State, i: int) -> State:
    """State number `i` of several."""
    rows = Rows(*(array[i] for array in states.rows))
    return State(states.q[i], states.frames[i], states.columns[i], rows, states.norms[i])


def make_clock(deadline: int = NEVER) -> NDArray[np.int64]:
    """A clock with this deadline, in nanoseconds: 0 is long past."""
    clock = np.zeros(CLOCK_SIZE, np.int64)
    clock[DEADLINE] = deadline
    return clock


def make_work(problem: Problem, deadline: int = NEVER) -> Work:
    """Scratch of a solve."""
    n, m = len(problem.limits), len(problem.scene.table)
    own = np.zeros((n, 9)), np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3))
    return Work(*own, np.zeros(n, np.int64), np.zeros(m, np.int64), make_clock(deadline), np.zeros(rest_size(n)))


def put(states: State, i: int, q: Floats) -> State:
    """Put a configuration into state number `i`, and return that state."""
    states.q[i] = q
    return state_of(states, i)
