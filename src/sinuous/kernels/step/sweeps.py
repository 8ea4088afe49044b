"""The Newton step of the whole robot in two sweeps: exact, linear in the number of segments.

Write every small motion as a twist `x = (omega, v)` in world axes. Then the world beyond segment k moves by
`x_k = x_{k-1} + B_k dq_k`: the dynamics of the chain is the identity. Every constraint is a *row* that is linear in the
twist at its place, `a . x + b . z = value`. The damped Gauss-Newton step

    minimise  sum over rows (a . x + b . z - value)^2 / mu  +  sum over segments |z_k|^2,     dq_k = mean_k + L_k z_k

is what a fixed-interval smoother computes for a random walk `x` with steps `B_k L_k z_k` and measurements of variance
`mu`. `forward` is the Kalman filter along the arc (covariance 6 x 6 of what the robot can still do), `backward` the
adjoint of Bryson & Frazier (Bierman 1973). Nothing is inverted but one number a row, and `mu -> 0` is well behaved:
rows are then met exactly, with the least motion that does so.

`L_k` (3 x 3) is the root of the metric in which motion is measured. Directions that a limit forbids are left out of
it, and `mean_k` is a motion decided beforehand: up to a bound, or towards a preference.

`columns` (n, 18) has the columns of all `B_k`, see `chain.kinematics`; `mean` (n, 3).
"""

from sinuous.kernels.body.rows import END, HARD, IDLE, SOFT, Rows
from sinuous.kernels.compile import inline
from sinuous.kernels.maths.vectors import (
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

Reach = tuple[Mat, Mat, Mat, Vec, Vec]
"""What the robot can still do up to here: covariance of (omega, omega), (omega, v), (v, v), and mean of omega and v."""

Sums = tuple[Mat, Mat, Mat, Vec]
"""The same of the sum of all motions: covariance with omega, with v, with itself, and mean."""

Own = tuple[Mat, Mat, Mat, Mat, Vec]
"""The same of the motion z of this segment: covariance with omega, v, the sum, itself, and mean."""

SOFT_VARIANCE = 1e-10
"""Variance of SOFT rows, whatever `mu`: far from the targets a wish weighs no less than near them."""

HARD_VARIANCE = 1e-10
"""Variance of HARD rows, relative to their weights: small, yet enough for two that say the same."""


INVERSE_VARIANCE = 12
"""Column of the gains that holds the inverse of the variance of what a row sees."""


def _mix(weights: Vec, x: Vec, y: Vec, z: Vec) -> Vec:
    return add_scaled(add_scaled(scale(weights[0], x), weights[1], y), weights[2], z)


def _spread(columns: Array, k: int, lines: Mat) -> tuple[Mat, Mat]:
    """`B_k L_k` as transposes, omega and v apart: one row a column of `L_k`; `lines` is `L_k` transposed."""
    x, y, z = get_vec(columns, k, 0), get_vec(columns, k, 6), get_vec(columns, k, 12)
    turn = (_mix(lines[0], x, y, z), _mix(lines[1], x, y, z), _mix(lines[2], x, y, z))
    x, y, z = get_vec(columns, k, 3), get_vec(columns, k, 9), get_vec(columns, k, 15)
    return turn, (_mix(lines[0], x, y, z), _mix(lines[1], x, y, z), _mix(lines[2], x, y, z))


def _sub_outer(m: Mat, a: Vec, b: Vec) -> Mat:
    """m - a b'."""
    return add_scaled(m[0], -a[0], b), add_scaled(m[1], -a[1], b), add_scaled(m[2], -a[2], b)


def _gram(m: Mat, a: Mat, b: Mat) -> Mat:
    """m + a' b."""
    return add_outer(add_outer(add_outer(m, a[0], b[0]), a[1], b[1]), a[2], b[2])


def _even(m: Mat) -> Mat:
    """A symmetric matrix by its upper half: what is computed of the other is never used."""
    return m[0], (m[0][1], m[1][1], m[1][2]), (m[0][2], m[1][2], m[2][2])


def _is_diagonal(m: Mat) -> bool:
    """Whether no coordinate is tied to another: it is so where no limit binds."""
    return m[0][1] == 0.0 and m[0][2] == 0.0 and m[1][0] == 0.0 and m[1][2] == 0.0 and m[2][0] == 0.0 and m[2][1] == 0.0


def extend(reach: Reach, columns: Array, k: int, L: Mat, mean: Vec) -> tuple[Reach, Mat, Mat]:
    """What the robot can do with one more segment that moves by `mean`, and `B_k L_k` as `_spread` has it.

    Where no limit binds there is half as much to multiply: stretching a segment turns nothing.
    """
    A, B, C, turned, moved = reach
    if mean[0] != 0.0 or mean[1] != 0.0 or mean[2] != 0.0:
        turned = add(turned, _mix(mean, get_vec(columns, k, 0), get_vec(columns, k, 6), get_vec(columns, k, 12)))
        moved = add(moved, _mix(mean, get_vec(columns, k, 3), get_vec(columns, k, 9), get_vec(columns, k, 15)))
    if _is_diagonal(L) and columns[k, 12] == 0.0 and columns[k, 13] == 0.0 and columns[k, 14] == 0.0:
        x, y = scale(L[0][0], get_vec(columns, k, 0)), scale(L[1][1], get_vec(columns, k, 6))
        u, v = scale(L[0][0], get_vec(columns, k, 3)), scale(L[1][1], get_vec(columns, k, 9))
        w = scale(L[2][2], get_vec(columns, k, 15))
        A, B = add_outer(add_outer(A, x, x), y, y), add_outer(add_outer(B, x, u), y, v)
        C = add_outer(add_outer(add_outer(C, u, u), v, v), w, w)
        return (_even(A), B, _even(C), turned, moved), (x, y, ZERO), (u, v, w)
    turn, move = _spread(columns, k, transpose(L))
    return (_even(_gram(A, turn, turn)), _gram(B, turn, move), _even(_gram(C, move, move)), turned, moved), turn, move


extend_here = inline(extend)


def _at_end(reach: Reach, rows: Rows, i: int, mu: float) -> Reach:
    """Take in one row that sees the twist alone."""
    A, B, C, turned, moved = reach
    a, c = get_vec(rows.twist, i, 0), get_vec(rows.twist, i, 3)
    turn, move = add(mat_vec(A, a), mat_vec(B, c)), add(vec_mat(a, B), mat_vec(C, c))
    f = 1.0 / (dot(a, turn) + dot(c, move) + mu)
    nu = rows.value[i] - dot(a, turned) - dot(c, moved)
    gain_turn, gain_move = scale(f, turn), scale(f, move)
    put_vec(rows.gain, i, 0, gain_turn)
    put_vec(rows.gain, i, 3, gain_move)
    rows.gain[i, INVERSE_VARIANCE] = f
    rows.innovation[i] = f * nu
    return (
        _even(_sub_outer(A, gain_turn, turn)),
        _sub_outer(B, gain_turn, move),
        _even(_sub_outer(C, gain_move, move)),
        add_scaled(turned, nu, gain_turn),
        add_scaled(moved, nu, gain_move),
    )


def _within(
    reach: Reach, own: Own, sums: Sums, L: Mat, m: Vec, rows: Rows, i: int, mu: float
) -> tuple[Reach, Own, Sums]:
    """Take in one row of any kind: it may also see the motion of its own segment, and the sum of all motions."""
    A, B, C, turned, moved = reach
    X, Y, R, Z, z = own
    P, Q, T, summed = sums
    kind = rows.kind[i]
    a, c = get_vec(rows.twist, i, 0), get_vec(rows.twist, i, 3)
    inner = get_vec(rows.inner, i, 0) if kind != END else ZERO
    s = get_vec(rows.total, i, 0) if kind == HARD else ZERO
    b = vec_mat(inner, L)
    turn = add(add(mat_vec(A, a), mat_vec(B, c)), add(vec_mat(b, X), vec_mat(s, P)))
    move = add(add(vec_mat(a, B), mat_vec(C, c)), add(vec_mat(b, Y), vec_mat(s, Q)))
    used = add(add(mat_vec(X, a), mat_vec(Y, c)), add(mat_vec(Z, b), mat_vec(R, s)))
    total = add(add(mat_vec(P, a), mat_vec(Q, c)), add(vec_mat(b, R), mat_vec(T, s)))
    spread = dot(a, turn) + dot(c, move) + dot(b, used) + dot(s, total)
    variance = mu
    if kind == HARD:
        variance = HARD_VARIANCE * (dot(b, b) + dot(s, s))
    elif kind == SOFT:
        variance = SOFT_VARIANCE
    f = 1.0 / (spread + variance)
    nu = rows.value[i] - dot(a, turned) - dot(c, moved) - dot(inner, m) - dot(b, z) - dot(s, summed)
    gain_turn, gain_move, gain_used, gain_total = scale(f, turn), scale(f, move), scale(f, used), scale(f, total)
    put_vec(rows.gain, i, 0, gain_turn)
    put_vec(rows.gain, i, 3, gain_move)
    put_vec(rows.gain, i, 6, gain_used)
    put_vec(rows.gain, i, 9, gain_total)
    rows.gain[i, INVERSE_VARIANCE] = f
    rows.innovation[i] = f * nu
    return (
        (
            _sub_outer(A, gain_turn, turn),
            _sub_outer(B, gain_turn, move),
            _sub_outer(C, gain_move, move),
            add_scaled(turned, nu, gain_turn),
            add_scaled(moved, nu, gain_move),
        ),
        (
            _sub_outer(X, gain_used, turn),
            _sub_outer(Y, gain_used, move),
            _sub_outer(R, gain_used, total),
            _sub_outer(Z, gain_used, used),
            add_scaled(z, nu, gain_used),
        ),
        (
            _sub_outer(P, gain_total, turn),
            _sub_outer(Q, gain_total, move),
            _sub_outer(T, gain_total, total),
            add_scaled(summed, nu, gain_total),
        ),
    )


def forward(columns: Array, root: Array, mean: Array, rows: Rows, mu: float, sums_from: int) -> None:
    """Filter along the arc from base to tip; fill `rows.gain` and `rows.innovation`.

    HARD rows may weigh the sum of all motions from the segment `sums_from` on; it is then part of the state. It is not
    where that is negative.
    """
    coupled = sums_from >= 0
    reach = (NOTHING, NOTHING, NOTHING, ZERO, ZERO)
    sums = (NOTHING, NOTHING, NOTHING, ZERO)
    for k in range(columns.shape[0]):
        L, m = get_mat(root, k, 0), get_vec(mean, k, 0)
        lines = transpose(L)
        reach, turn, move = extend_here(reach, columns, k, L, m)
        if coupled and k >= sums_from:
            P, Q, T, summed = sums
            sums = (_gram(P, lines, turn), _gram(Q, lines, move), _gram(T, lines, lines), add(summed, m))
        own = (turn, move, lines, IDENTITY, ZERO)
        for i in range(rows.start[k], rows.start[k + 1]):
            if rows.kind[i] == END and not coupled:
                reach = _at_end(reach, rows, i, mu)
            elif rows.kind[i] != IDLE:
                reach, own, sums = _within(reach, own, sums, L, m, rows, i, mu)


def forward_again(columns: Array, root: Array, mean: Array, rows: Rows, sums_from: int) -> None:
    """Filter another `mean` while every row asks for 0; fill `rows.innovation`.

    `forward` has filled the gains, which are the same for any mean and any values, so means alone are carried.
    """
    turned, moved, summed = ZERO, ZERO, ZERO
    coupled = sums_from >= 0
    for k in range(columns.shape[0]):
        L, m = get_mat(root, k, 0), get_vec(mean, k, 0)
        turned = add(turned, _mix(m, get_vec(columns, k, 0), get_vec(columns, k, 6), get_vec(columns, k, 12)))
        moved = add(moved, _mix(m, get_vec(columns, k, 3), get_vec(columns, k, 9), get_vec(columns, k, 15)))
        if k >= sums_from:
            summed = add(summed, m)
        z = ZERO
        for i in range(rows.start[k], rows.start[k + 1]):
            kind = rows.kind[i]
            if kind == IDLE:
                continue
            nu = -dot(get_vec(rows.twist, i, 0), turned) - dot(get_vec(rows.twist, i, 3), moved)
            if kind != END:
                nu -= dot(get_vec(rows.inner, i, 0), add(m, mat_vec(L, z)))
            if kind == HARD and coupled:
                nu -= dot(get_vec(rows.total, i, 0), summed)
            rows.innovation[i] = rows.gain[i, INVERSE_VARIANCE] * nu
            turned = add_scaled(turned, nu, get_vec(rows.gain, i, 0))
            moved = add_scaled(moved, nu, get_vec(rows.gain, i, 3))
            if kind != END:
                z = add_scaled(z, nu, get_vec(rows.gain, i, 6))
            if coupled:
                summed = add_scaled(summed, nu, get_vec(rows.gain, i, 9))


def backward(columns: Array, root: Array, mean: Array, rows: Rows, step: Array, sums_from: int) -> None:
    """Carry the adjoint from tip to base; fill `step` (n, 3) with dq."""
    turn, move, total = ZERO, ZERO, ZERO
    coupled = sums_from >= 0
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
            if kind == HARD and coupled:
                total = add_scaled(total, push, get_vec(rows.total, i, 0))
            turn = add_scaled(turn, push, get_vec(rows.twist, i, 0))
            move = add_scaled(move, push, get_vec(rows.twist, i, 3))
        if k < sums_from:
            total = ZERO
        pull = (
            dot(get_vec(columns, k, 0), turn) + dot(get_vec(columns, k, 3), move) + total[0],
            dot(get_vec(columns, k, 6), turn) + dot(get_vec(columns, k, 9), move) + total[1],
            dot(get_vec(columns, k, 12), turn) + dot(get_vec(columns, k, 15), move) + total[2],
        )
        put_vec(step, k, 0, add(get_vec(mean, k, 0), mat_vec(L, add(z, vec_mat(pull, L)))))
