"""What a solve works on: configurations, what follows from them, and scratch, all in one buffer."""

from collections import namedtuple

import numpy as np

from sinuous.kernels.body.contacts import PER_SEGMENT
from sinuous.kernels.body.rows import carve_rows, pick_rows, rows_size
from sinuous.kernels.chain.kinematics import frame, put_frame
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.problem import Problem

State = namedtuple("State", ["q", "frames", "columns", "rows", "norms"])
"""A configuration and the problem linearised there. `norms`: merit, position error, angle error,
least clearance seen, and how far wishes for clearance are from met."""

Work = namedtuple("Work", ["root", "mean", "step", "solved", "bound", "among", "clock"])
"""Scratch of one solve; `clock`: see `kernels.clock`."""

STATES = 3
"""States in a workspace: two take turns in a descent, a third serves corrections."""

MERIT, POSITION, ANGLE, SEEN, WISH = 0, 1, 2, 3, 4


def workspace_size(segments: int, actuators: int, obstacles: int, targets: int) -> int:
    """Numbers (float64) that a solve needs as workspace."""
    capacity = 6 * targets + (segments * PER_SEGMENT if obstacles > 0 else 0) + actuators
    return STATES * (33 * segments + 18 + 27 * capacity + segments) + 19 * segments + obstacles + CLOCK_SIZE


@kernel
def carve(buffer: Array, problem: Problem) -> tuple[State, Work]:
    """Lay out workspace: several states, as arrays with one more axis in front (see `pick`), and scratch."""
    return carve_for(buffer, problem, problem.scene.table.shape[0])


@kernel
def carve_for(buffer: Array, problem: Problem, obstacles: int) -> tuple[State, Work]:
    """Lay out workspace as for so many obstacles: with one there is a place for rows along the body."""
    n, m, c = problem.limits.shape[0], obstacles, STATES
    capacity = 6 * problem.targets.shape[0] + problem.actuation.shape[0] + (n * PER_SEGMENT if m > 0 else 0)
    size = c * (33 * n + 17)
    frames = buffer[3 * n * c : (15 * n + 12) * c].reshape((c, n + 1, 12))
    rotation, position = frame(problem.base, 0)
    for i in range(c):
        put_frame(frames[i], 0, rotation, position)
    states = State(
        buffer[: 3 * n * c].reshape((c, n, 3)),
        frames,
        buffer[(15 * n + 12) * c : (33 * n + 12) * c].reshape((c, n, 18)),
        carve_rows(buffer[size:], c, n, capacity),
        buffer[(33 * n + 12) * c : size].reshape((c, 5)),
    )
    rest = buffer[size + c * rows_size(n, capacity) :]
    work = Work(
        rest[: 9 * n].reshape((n, 9)),
        rest[9 * n : 12 * n].reshape((n, 3)),
        rest[12 * n : 15 * n].reshape((n, 3)),
        rest[15 * n : 18 * n].reshape((n, 3)),
        rest[18 * n : 19 * n].view(np.int64),
        rest[19 * n : 19 * n + m].view(np.int64),
        rest[19 * n + m : 19 * n + m + CLOCK_SIZE].view(np.int64),
    )
    return states, work


@kernel
def pick(states: State, i: int) -> State:
    """State number `i` of several."""
    return State(states.q[i], states.frames[i], states.columns[i], pick_rows(states.rows, i), states.norms[i])
