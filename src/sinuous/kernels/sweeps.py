"""The Newton step of the whole robot in two sweeps: exact, linear in the number of segments.

Write every small motion as a twist `x = (omega, v)` in world axes. Then the world beyond segment k moves by
`x_k = x_{k-1} + B_k dq_k`: the dynamics of the chain is the identity. Every constraint is a *row* that is linear in the
twist at its place, `a . x + b . z = value`. The damped Gauss-Newton step

    minimise  sum over rows (a . x + b . z - value)^2 / mu  +  sum over segments |z_k|^2,     dq_k = mean_k + L_k z_k

is what a fixed-interval smoother computes for a random walk `x` with steps `B_k L_k z_k` and measurements of variance
`mu`. `forward` is the Kalman filter along the arc (covariance 6 x 6 of what the robot can still do), `backward` the adjoint
of Bryson & Frazier (Bierman 1973). Nothing is inverted but one number a row, and `mu -> 0` is well behaved: rows
are then met exactly, with the least motion that does so.

`L_k` (3 x 3) is the root of the metric in which motion is measured. Directions that a limit forbids are left out of it, and
`mean_k` is a motion decided beforehand: up to a bound, or towards a preference.
"""

from collections import namedtuple

import numpy as np

from sinuous.kernels.compile import kernel
from sinuous.kernels.vectors import (
    IDENTITY,
    NOTHING,
    ZERO,
    Array,
    Mat,
    Vec,
    add,
    add_outer,
    add_scaled,
    dot,
    get_mat,
    get_vec,
    mat_vec,
    put_vec,
    scale,
    transpose,
    vec_mat,
)

Rows = namedtuple("Rows", ["start", "kind", "twist", "inner", "total", "value", "gain", "innovation"])
"""The constraints of a step, in the order of their segments.

`start` (n + 1,): rows `start[k]` to `start[k + 1]` belong to segment k. `kind` (m,): END, at the end of the segment (these come
last in it); INNER, within the body; HARD, met exactly whatever `mu`; IDLE, left out. `twist` (m, 6) is `a`, seen from the end
of the segment; `inner` (m, 3) is `b` in the coordinates of `q_k`, for INNER and HARD; `total` (m, 3) weighs the sum of all `dq` up
to this segment, for HARD: actuators that run through several segments see no more than that. `value` (m,). The sweeps
fill `gain` (m, 12) and `innovation` (m,).
"""

END, INNER, HARD, IDLE = 0, 1, 2, 3

HARD_SHARE = 1e-10
"""Variance of HARD rows, relative to their weights: small, yet enough for two that say the same."""


@kernel
def rows_size(segments: int, capacity: int) -> int:
    """Numbers that `carve_rows` takes from a buffer."""
    return segments + 1 + 27 * capacity


@kernel
def carve_rows(buffer: Array, segments: int, capacity: int) -> Rows:
    """Lay out rows in the beginning of `buffer`."""
    at = segments + 1
    m = capacity
    return Rows(
        buffer[:at].view(np.int64),
        buffer[at : at + m].view(np.int64),
        buffer[at + m : at + 7 * m].reshape((m, 6)),
        buffer[at + 7 * m : at + 10 * m].reshape((m, 3)),
        buffer[at + 10 * m : at + 13 * m].reshape((m, 3)),
        buffer[at + 13 * m : at + 14 * m],
        buffer[at + 14 * m : at + 26 * m].reshape((m, 12)),
        buffer[at + 26 * m : at + 27 * m],
    )


@kernel
def _mix(weights: Vec, x: Vec, y: Vec, z: Vec) -> Vec:
    return add_scaled(add_scaled(scale(weights[0], x), weights[1], y), weights[2], z)


@kernel
def _spread(columns: Array, k: int, lines: Mat) -> tuple[Mat, Mat]:
    """`B_k L_k` as transposes, omega and v apart: one row a column of `L_k`; `lines` is `L_k` transposed."""
    x, y, z = get_vec(columns, k, 0), get_vec(columns, k, 6), get_vec(columns, k, 12)
    turn = (_mix(lines[0], x, y, z), _mix(lines[1], x, y, z), _mix(lines[2], x, y, z))
    x, y, z = get_vec(columns, k, 3), get_vec(columns, k, 9), get_vec(columns, k, 15)
    return turn, (_mix(lines[0], x, y, z), _mix(lines[1], x, y, z), _mix(lines[2], x, y, z))


@kernel
def _gram(m: Mat, a: Mat, b: Mat) -> Mat:
    """m + a' b."""
    return add_outer(add_outer(add_outer(m, a[0], b[0]), a[1], b[1]), a[2], b[2])


@kernel
def forward(columns: Array, root: Array, mean: Array, rows: Rows, mu: float, coupled: bool) -> None:
    """Filter along the arc from base to tip; fill `rows.gain` and `rows.innovation`.

    The state is the twist `(omega, v)`, and with `coupled` also the sum `c` of all motions so far, which HARD rows may weigh.
    """
    A, B, C = NOTHING, NOTHING, NOTHING  # covariance of (omega, omega), (omega, v), (v, v)
    P, Q, T = NOTHING, NOTHING, NOTHING  # of (c, omega), (c, v), (c, c)
    turned, moved, summed = ZERO, ZERO, ZERO
    for k in range(columns.shape[0]):
        L = get_mat(root, k, 0)
        lines = transpose(L)
        turn, move = _spread(columns, k, lines)
        A, B, C = _gram(A, turn, turn), _gram(B, turn, move), _gram(C, move, move)
        m = get_vec(mean, k, 0)
        turned = add(turned, _mix(m, get_vec(columns, k, 0), get_vec(columns, k, 6), get_vec(columns, k, 12)))
        moved = add(moved, _mix(m, get_vec(columns, k, 3), get_vec(columns, k, 9), get_vec(columns, k, 15)))
        if coupled:
            P, Q, T = _gram(P, lines, turn), _gram(Q, lines, move), _gram(T, lines, lines)
            summed = add(summed, m)
        # Covariance of the motion z of this segment with omega, v, c and itself; mean of z.
        X, Y, R, Z, z = turn, move, lines, IDENTITY, ZERO
        for i in range(rows.start[k], rows.start[k + 1]):
            kind = rows.kind[i]
            if kind == IDLE:
                continue
            a, c = get_vec(rows.twist, i, 0), get_vec(rows.twist, i, 3)
            used_turn = add(mat_vec(A, a), mat_vec(B, c))
            used_move = add(vec_mat(a, B), mat_vec(C, c))
            nu = rows.value[i] - dot(a, turned) - dot(c, moved)
            b, s, used, used_sum = ZERO, ZERO, ZERO, ZERO
            if kind != END:
                within = get_vec(rows.inner, i, 0)
                b = vec_mat(within, L)
                nu -= dot(within, m) + dot(b, z)
                used_turn = add(used_turn, vec_mat(b, X))
                used_move = add(used_move, vec_mat(b, Y))
                used = add(add(mat_vec(X, a), mat_vec(Y, c)), mat_vec(Z, b))
            if coupled:
                used_sum = add(mat_vec(P, a), mat_vec(Q, c))
                if kind != END:
                    used_sum = add(used_sum, vec_mat(b, R))
                if kind == HARD:
                    s = get_vec(rows.total, i, 0)
                    nu -= dot(s, summed)
                    used_turn, used_move = add(used_turn, vec_mat(s, P)), add(used_move, vec_mat(s, Q))
                    used, used_sum = add(used, mat_vec(R, s)), add(used_sum, mat_vec(T, s))
            spread = dot(a, used_turn) + dot(c, used_move) + dot(b, used) + dot(s, used_sum)
            f = 1.0 / (spread + (mu if kind != HARD else HARD_SHARE * (dot(b, b) + dot(s, s))))
            used_turn_f, used_move_f = scale(f, used_turn), scale(f, used_move)
            used_f, used_sum_f = scale(f, used), scale(f, used_sum)
            A = add_outer(A, scale(-1.0, used_turn_f), used_turn)
            B = add_outer(B, scale(-1.0, used_turn_f), used_move)
            C = add_outer(C, scale(-1.0, used_move_f), used_move)
            turned, moved = add_scaled(turned, nu, used_turn_f), add_scaled(moved, nu, used_move_f)
            if kind != END:
                out = scale(-1.0, used_f)
                X, Y, Z = add_outer(X, out, used_turn), add_outer(Y, out, used_move), add_outer(Z, out, used)
                R = add_outer(R, out, used_sum)
                z = add_scaled(z, nu, used_f)
            if coupled:
                out = scale(-1.0, used_sum_f)
                P, Q, T = add_outer(P, out, used_turn), add_outer(Q, out, used_move), add_outer(T, out, used_sum)
                summed = add_scaled(summed, nu, used_sum_f)
            put_vec(rows.gain, i, 0, used_turn_f)
            put_vec(rows.gain, i, 3, used_move_f)
            put_vec(rows.gain, i, 6, used_f)
            put_vec(rows.gain, i, 9, used_sum_f)
            rows.innovation[i] = f * nu


@kernel
def backward(columns: Array, root: Array, mean: Array, rows: Rows, step: Array, coupled: bool) -> None:
    """Carry the adjoint from tip to base; fill `step` (n, 3) with dq."""
    turn, move, total = ZERO, ZERO, ZERO
    for k in range(columns.shape[0] - 1, -1, -1):
        L = get_mat(root, k, 0)
        z = ZERO
        for i in range(rows.start[k + 1] - 1, rows.start[k] - 1, -1):
            kind = rows.kind[i]
            if kind == IDLE:
                continue
            push = rows.innovation[i] - dot(get_vec(rows.gain, i, 0), turn) - dot(get_vec(rows.gain, i, 3), move)
            if coupled:
                push -= dot(get_vec(rows.gain, i, 9), total)
            if kind != END:
                push -= dot(get_vec(rows.gain, i, 6), z)
                z = add_scaled(z, push, vec_mat(get_vec(rows.inner, i, 0), L))
            if kind == HARD:
                total = add_scaled(total, push, get_vec(rows.total, i, 0))
            turn = add_scaled(turn, push, get_vec(rows.twist, i, 0))
            move = add_scaled(move, push, get_vec(rows.twist, i, 3))
        pull = (
            dot(get_vec(columns, k, 0), turn) + dot(get_vec(columns, k, 3), move) + total[0],
            dot(get_vec(columns, k, 6), turn) + dot(get_vec(columns, k, 9), move) + total[1],
            dot(get_vec(columns, k, 12), turn) + dot(get_vec(columns, k, 15), move) + total[2],
        )
        put_vec(step, k, 0, add(get_vec(mean, k, 0), mat_vec(L, add(z, vec_mat(pull, L)))))
