"""Rows `c . dq = value` that see several segments, added after the sweeps; all of them are self-contacts today.

Let H be the matrix of the damped Gauss-Newton step without them, and L the root of its metric. `H^-1 c` comes from the
same two sweeps, of the mean `L L' c` with no row asking for anything: covariances and gains do not depend on values, so
the second time means alone are carried. The step with m such rows is then, exactly (Woodbury),

    dq + sum over a of x_a H^-1 c_a,    sum over b of (c_a . H^-1 c_b + mu [a = b]) x_b = value_a - c_a . dq

Of more than `MOST_PAIRS` self-contacts those that overlap the most enter a step; later steps see the others.

`columns` (n, 18) are those of `chain.kinematics`; `weights` (m, 3 n or more) and `pairs` (m, 1 + 3 n) have a row for
each self-contact.
"""

from sinuous.kernels.body.rows import Rows
from sinuous.kernels.body.self_contacts import PAIR_VALUE, PAIR_WEIGHTS
from sinuous.kernels.maths.vectors import Array, add_scaled, dot, get_mat, get_vec, mat_vec, put_vec, vec_mat
from sinuous.kernels.step import sweeps
from sinuous.kernels.step.dense import solve_symmetric
from sinuous.kernels.step.states import PAIRS, State, Work, coupling_of

LEAST_PIVOT = 1e-12
"""What keeps two self-contacts that say the same from leaving nothing to divide by."""


def apply_inverse(
    columns: Array, root: Array, weights: Array, a: int, first: int, rows: Rows, pull: Array, out: Array, sums_from: int
) -> None:
    """Fill `out` (n, 3) with `H^-1 c`, for the weights c in row `a` of `weights` from column `first` on.

    The sweeps of the step have been made with these `columns`, `root` and `rows`; `pull` (n, 3) is scratch.
    """
    for k in range(columns.shape[0]):
        L = get_mat(root, k, 0)
        put_vec(pull, k, 0, mat_vec(L, vec_mat(get_vec(weights, a, first + 3 * k), L)))
    sweeps.forward_again(columns, root, pull, rows, sums_from)
    sweeps.backward(columns, root, pull, rows, out, sums_from)


def couple(state: State, work: Work, mu: float, sums_from: int) -> None:
    """Add to `work.step`, which both sweeps just made, what the self-contacts of `state` ask for."""
    n, count = state.q.shape[0], int(state.norms[PAIRS])
    pairs, _, pull, replies, system = coupling_of(state, work)
    for a in range(count):
        apply_inverse(state.columns, work.root, pairs, a, PAIR_WEIGHTS, state.rows, pull, replies[a], sums_from)
        for b in range(a + 1):
            system[a, b] = system[b, a] = _seen(pairs, b, replies[a])
        system[a, a] += mu + LEAST_PIVOT
    for a in range(count):
        system[a, count] = pairs[a, PAIR_VALUE] - _seen(pairs, a, work.step)
    solve_symmetric(system, count)
    for a in range(count):
        for k in range(n):
            put_vec(work.step, k, 0, add_scaled(get_vec(work.step, k, 0), system[a, count], get_vec(replies[a], k, 0)))


def _seen(pairs: Array, a: int, step: Array) -> float:
    """What self-contact `a` sees of a step (n, 3)."""
    total = 0.0
    for k in range(step.shape[0]):
        total += dot(get_vec(pairs, a, PAIR_WEIGHTS + 3 * k), get_vec(step, k, 0))
    return total
