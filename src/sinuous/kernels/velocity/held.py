"""The rows that a step would leave, held by forces that push and never pull.

Let H be the matrix of the damped step without any of them, and `c` the weights of a row, `c . dq >= value`. The least
motion that keeps them all is `dq + sum of x_a H^-1 c_a` with `x >= 0` where
`(c_a . H^-1 c_b + softness_a [a = b]) x_b >= value_a - c_a . dq`, and one of the two holds with equality: the dual of
a quadratic program, solved by active sets (Lawson & Hanson 1974; Goldfarb & Idnani 1983 for taking in the row that is
left the most). `H^-1 c` comes from the two sweeps that made the step, see `step.coupling`.
"""

from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array, get_mat, get_vec, mat_vec, put_vec, vec_mat
from sinuous.kernels.step import sweeps
from sinuous.kernels.step.coupling import solve_symmetric
from sinuous.kernels.velocity.working import FORCE, SOFTNESS, VALUE, Held, Tick

HARD = 1e-13
"""Variance of rows that must hold: enough for two that say the same."""


@kernel
def along(weights: Array, motion: Array) -> float:
    """What a row of weights (3 n or more,) sees of a motion (n, 3)."""
    total = 0.0
    for k in range(motion.shape[0]):
        total += weights[3 * k] * motion[k, 0] + weights[3 * k + 1] * motion[k, 1] + weights[3 * k + 2] * motion[k, 2]
    return total


@kernel
def _dot(a: Array, b: Array) -> float:
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i] * b[i]
    return total


@kernel
def take_in(tick: Tick, count: int) -> None:
    """Compute what row `count` of those held moves; weights and value are there."""
    held, n = tick.held, tick.q.shape[0]
    for k in range(n):
        L, c = get_mat(tick.root, k, 0), get_vec(held.weights, count, 3 * k)
        put_vec(held.pull, k, 0, mat_vec(L, vec_mat(c, L)))
    sweeps.forward_again(tick.columns, tick.root, held.pull, tick.rows, False)
    sweeps.backward(tick.columns, tick.root, held.pull, tick.rows, tick.trial, False)
    for k in range(n):
        for i in range(3):
            held.replies[count, 3 * k + i] = tick.trial[k, i]
    for b in range(count + 1):
        held.system[count, b] = held.system[b, count] = _dot(held.weights[b], held.replies[count])
    held.system[count, count] += held.about[count, SOFTNESS]
    held.about[count, VALUE] -= along(held.weights[count], held.free)
    held.about[count, FORCE] = 0.0
    held.active[count] = 0


@kernel
def most_left(held: Held, count: int) -> tuple[int, float]:
    """The row that does not push, and is left the most, and by how much; -1 where there is none."""
    worst, excess = -1, 0.0
    for a in range(count):
        if held.active[a] == 0:
            missing = held.about[a, VALUE]
            for b in range(count):  # who does not push has no force
                missing -= held.system[a, b] * held.about[b, FORCE]
            if missing > excess:
                worst, excess = a, missing
    return worst, excess


@kernel
def _solve_active(held: Held, count: int) -> int:
    """Solve for the forces of the rows that push; returns how many those are, their forces in the last column."""
    m = 0
    for a in range(count):
        if held.active[a] != 0:
            held.pushing[m] = a
            m += 1
    for i in range(m):
        a = held.pushing[i]
        for j in range(i, m):  # what is below the diagonal is never read
            held.scratch[i, j] = held.system[a, held.pushing[j]]
        held.scratch[i, m] = held.about[a, VALUE]
    solve_symmetric(held.scratch, m)
    return m


@kernel
def push(held: Held, count: int, a: int) -> None:
    """Let row `a` push, too, and find all forces: rows that would have to pull are let go."""
    held.active[a] = 1
    for _ in range(2 * count + 2):
        m = _solve_active(held, count)
        share = 1.0
        for i in range(m):
            force = held.scratch[i, m]
            if force <= 0.0:
                before = held.about[held.pushing[i], FORCE]
                share = min(share, before / (before - force) if before > force else 0.0)
        left = False
        for i in range(m):
            b, force = held.pushing[i], held.scratch[i, m]
            before = held.about[b, FORCE]
            moved = before + share * (force - before)
            if share < 1.0 and force <= 0.0 and moved <= 1e-12 * (abs(force) + before):
                moved, left = 0.0, True
                held.active[b] = 0
            held.about[b, FORCE] = moved
        if not left:
            return


@kernel
def combine(held: Held, count: int, step: Array) -> None:
    """Fill `step` (n, 3) with the step that the forces make."""
    n = step.shape[0]
    for k in range(n):
        put_vec(step, k, 0, get_vec(held.free, k, 0))
    for a in range(count):
        if held.active[a] != 0:
            force = held.about[a, FORCE]
            for k in range(n):
                for i in range(3):
                    step[k, i] += force * held.replies[a, 3 * k + i]
