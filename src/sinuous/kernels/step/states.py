"""What a solve works on: configurations, what follows from them, and scratch, all in one buffer."""

from collections import namedtuple

from sinuous.kernels.body.contacts import PER_SEGMENT
from sinuous.kernels.body.rows import carve_rows, pick_rows, rows_size
from sinuous.kernels.body.self_contacts import MOST_PAIRS, pair_width
from sinuous.kernels.body.self_pairs import SPAN_WIDTH
from sinuous.kernels.chain.kinematics import put_base
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.fields.distances import number_of
from sinuous.kernels.maths.buffers import cut, cut_whole
from sinuous.kernels.maths.vectors import Array
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.dense import dense_size

State = namedtuple("State", ["q", "frames", "columns", "rows", "norms"])
"""A configuration and the problem linearised there. `norms`: merit, position error, angle error,
least clearance seen, how far wishes for clearance are from met, a lower bound of the self-clearance (infinite: it was
not examined), and the number of self-contacts; then a row (1 + 3 n) for each of them, see `coupling_of`."""

Work = namedtuple("Work", ["root", "mean", "step", "solved", "bound", "among", "clock", "rest"])
"""Scratch of one solve; `clock`: see `kernels.clock`. `rest` holds what few solves need, in one array: each array costs
time whenever a kernel is called. See `coupling_of`."""

Coupling = namedtuple("Coupling", ["pairs", "spans", "pull", "replies", "system"])
"""What serves self-contacts: those of a state, up to m (m, 1 + 3 n); spans of the body (n + 1, 5), see `self_pairs`; a
motion (n, 3); what each of them moves (m, n, 3); and a system of equations (m, m + 1)."""

STATES = 3
"""States in a workspace: two take turns in a descent, a third serves corrections."""

MERIT, POSITION, ANGLE, CLEARANCE_SEEN, WISH, SELF_BOUND, PAIRS = range(7)

NORMS = 7


def workspace_size(segments: int, actuators: int, obstacles: int, targets: int) -> int:
    """Numbers (float64) that a solve needs as workspace."""
    capacity = 6 * targets + (segments * PER_SEGMENT if obstacles > 0 else 0) + actuators
    state = 33 * segments + 12 + NORMS + rows_size(segments, capacity) + MOST_PAIRS * pair_width(segments)
    return STATES * state + 19 * segments + obstacles + CLOCK_SIZE + rest_size(segments)


def rest_size(segments: int) -> int:
    """Numbers of what few solves need: what serves self-contacts, or in its place a dense system."""
    coupling = 3 * segments * (1 + MOST_PAIRS) + MOST_PAIRS * (MOST_PAIRS + 1)
    return max(SPAN_WIDTH * (segments + 1) + coupling, dense_size(segments))


def carve(buffer: Array, problem: Problem) -> tuple[State, Work]:
    """Lay out workspace: several states, as arrays with one more axis in front (see `pick`), and scratch."""
    return carve_for(buffer, problem, number_of(problem.scene))


def carve_for(buffer: Array, problem: Problem, obstacles: int) -> tuple[State, Work]:
    """Lay out workspace as for so many obstacles: with one there is a place for rows along the body."""
    n, c = problem.limits.shape[0], STATES
    capacity = 6 * problem.targets.shape[0] + problem.actuation.shape[0] + (n * PER_SEGMENT if obstacles > 0 else 0)
    q, rest = cut(buffer, c, n, 3)
    frames, rest = cut(rest, c, n + 1, 12)
    for i in range(c):
        put_base(frames[i], problem.base)
    columns, rest = cut(rest, c, n, 18)
    norms, rest = cut(rest, c, NORMS + MOST_PAIRS * pair_width(n))
    rows = carve_rows(rest, c, n, capacity)
    _, rest = cut(rest, c * rows_size(n, capacity))
    root, rest = cut(rest, n, 9)
    mean, rest = cut(rest, n, 3)
    own, rest = cut(rest, n, 3)
    solved, rest = cut(rest, n, 3)
    bound, rest = cut_whole(rest, n)
    among, rest = cut_whole(rest, obstacles)
    clock, rest = cut_whole(rest, CLOCK_SIZE)
    return State(q, frames, columns, rows, norms), Work(root, mean, own, solved, bound, among, clock, rest)


def pick(states: State, i: int) -> State:
    """State number `i` of several."""
    return State(states.q[i], states.frames[i], states.columns[i], pick_rows(states.rows, i), states.norms[i])


def coupling_of(state: State, work: Work) -> Coupling:
    """Lay out what serves self-contacts of a state."""
    n, m = work.step.shape[0], MOST_PAIRS
    pairs, _ = cut(state.norms[NORMS:], m, pair_width(n))
    spans, rest = cut(work.rest, n + 1, SPAN_WIDTH)
    pull, rest = cut(rest, n, 3)
    replies, rest = cut(rest, m, n, 3)
    system, _ = cut(rest, m, m + 1)
    return Coupling(pairs, spans, pull, replies, system)
