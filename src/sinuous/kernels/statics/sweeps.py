"""A Newton step of the equilibrium in two sweeps, in time linear in the number of arcs.

All in world axes about the base. Beyond arc k the body moves by the twist `xi_k = xi_(k-1) + B_k dx_k`; the loads
beyond have the wrench `F_k`. The virtual work of arc k leaves the residual `r_k = e_k' - B_k' F_k`. In its derivative,
`B_k` turns with `xi_(k-1)` and bends with `dx_k`, and dead loads change their moment alone, by `P_k xi_k + s_k` with P
(3, 6). From the tip to the base every arc is answered by `dx_k = k_k + K_k xi_(k-1)`, which leaves P and s for the arc
before: the elimination of a block tridiagonal matrix. Its pivots have the signs of the eigenvalues of the second
derivative of the energy, wherever there is one: moments that stay as they are in the world have no energy.
"""

from sinuous.kernels.chain.arc import pose_and_columns
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.maths.vectors import (
    Array,
    Vec,
    add,
    add_scaled,
    cross,
    dot,
    get_vec,
    mat_vec,
    put_vec,
    scale,
    sub,
    vec_mat,
)
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.profile import by_bends, by_length, end_profile, even_functions

NEUTRAL = 1e-7
"""Pivot, relative to the stiffness of the arc, that counts as none: a buckled column turns about its axis freely."""

Wrench = tuple[Vec, Vec]


def factorise(
    x: Array, frames: Array, arcs: Array, loads: Array, load_factor: float, more: float, stages: Array, scratch: Array
) -> tuple[int, Vec, Vec]:
    """Sweep from tip to base: fill residuals and factors of `stages`.

    Parameters
    ----------
    loads : ndarray (k, 10)
        In the order of their arcs; `load_factor` of them acts.
    more : float
        By what share of their stiffness all arcs are made stiffer.
    scratch : ndarray (11, 12)

    Returns
    -------
    int, Vec, Vec
        How many pivots are negative; and the wrench of all loads about the base.
    """
    origin = frame(frames, 0)[1]
    moment, force = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    P = scratch[8:11]
    P[:] = 0.0
    negative = 0
    last = loads.shape[0] - 1
    for k in range(x.shape[0] - 1, -1, -1):
        while last >= 0 and loads[last, t.LOAD_ARC] >= k:
            m, f, p = _load_at(frames, loads, last, load_factor, origin)
            moment, force = add(moment, add(m, cross(p, f))), add(force, f)
            _add_load_stiffness(P, p, f)
            last -= 1
        _fill_pivot(x, frames, k, origin, moment, force, P, stages, scratch)
        negative += _invert_pivot(arcs, k, more, stages, scratch)
        weight = scale(load_factor, get_vec(arcs, k, t.WEIGHT))
        _pass_to_arc_before(k, weight, P, stages, scratch)
        center = get_vec(stages, k, t.ARC_CENTER)
        moment, force = add(moment, cross(center, weight)), add(force, weight)
    return negative, moment, force


def _load_at(frames: Array, loads: Array, i: int, load_factor: float, origin: Vec) -> tuple[Vec, Vec, Vec]:
    """Moment and force of a load, and where it acts, from the base."""
    rotation, position = frame(frames, int(loads[i, t.LOAD_ARC]) + 1)
    place = add(sub(position, origin), mat_vec(rotation, get_vec(loads, i, t.LOAD_OFFSET)))
    return scale(load_factor, get_vec(loads, i, t.MOMENT)), scale(load_factor, get_vec(loads, i, t.FORCE)), place


def _add_load_stiffness(P: Array, p: Vec, f: Vec) -> None:
    """Add to `P` (3, 6) how the moment about the base of a force f at p changes with a twist: `(v + omega x p) x f`."""
    along = dot(p, f)
    for i in range(3):
        for j in range(3):
            P[i, j] += p[i] * f[j]
        P[i, i] -= along
    P[0, 4] += f[2]
    P[0, 5] -= f[1]
    P[1, 3] -= f[2]
    P[1, 5] += f[0]
    P[2, 3] += f[1]
    P[2, 4] -= f[0]


def _fill_pivot(
    x: Array, frames: Array, k: int, origin: Vec, moment: Vec, force: Vec, P: Array, stages: Array, scratch: Array
) -> None:
    """Fill the residual of arc k; `scratch` (11, 12): in rows 0 to 3 its pivot (4) and what twists ask of it (6).

    `P` (3, 6): how the moment of all beyond changes with a twist.
    """
    _bend_wrench(x, frames, k, origin, moment, force, scratch)
    for i in range(4):
        omega, v = get_vec(stages, k, t.TWIST_COLUMNS + 6 * i), get_vec(stages, k, t.TWIST_COLUMNS + 6 * i + 3)
        stages[k, t.RESIDUAL + i] = stages[k, t.GRADIENT + i] - dot(omega, moment) - dot(v, force)
        turning, moving = add(cross(omega, moment), cross(v, force)), cross(omega, force)
        for j in range(3):
            back, ahead = 0.0, 0.0
            for m in range(3):
                back += omega[m] * P[m, j]
                ahead += omega[m] * P[m, 3 + j]
            scratch[i, 4 + j] = turning[j] + back
            scratch[i, 7 + j] = moving[j] + ahead
        push = (0.0, 0.0, 0.0)
        for j in range(3):
            a, b, c = P[0, j], P[1, j], P[2, j]
            d, e, f = P[0, 3 + j], P[1, 3 + j], P[2, 3 + j]
            push = (
                push[0] + a * omega[j] + d * v[j],
                push[1] + b * omega[j] + e * v[j],
                push[2] + c * omega[j] + f * v[j],
            )
        put_vec(stages, k, t.PUSH + 3 * i, push)
    for i in range(4):
        omega = get_vec(stages, k, t.TWIST_COLUMNS + 6 * i)
        for j in range(4):
            pushed = dot(omega, get_vec(stages, k, t.PUSH + 3 * j))
            pivot = stages[k, t.HESSIAN + 4 * i + j] - scratch[4 + i, j] - pushed
            scratch[i, j] = stages[k, t.PIVOT + 4 * i + j] = pivot


def _bend_wrench(x: Array, frames: Array, k: int, origin: Vec, moment: Vec, force: Vec, scratch: Array) -> None:
    """Fill rows 4 to 7 of `scratch` (11, 12): derivatives (4, 4) of `B_k' F` by the state of arc k."""
    rotation, position = frame(frames, k)
    vx, vy, length = x[k, t.BEND_X], x[k, t.BEND_Y], x[k, t.LENGTH]
    f = vec_mat(force, rotation)
    _, end, by_x, by_y, stretch = pose_and_columns(vx, vy, length)
    about = sub(vec_mat(sub(moment, cross(sub(position, origin), force)), rotation), cross(end, f))
    even = even_functions(vx * vx + vy * vy)
    own = end_profile(even)
    xx, xy, yy = by_bends(vx, vy, f, length, own)
    xl, yl = by_length(vx, vy, f, own)
    axis = (even[0] * vx, even[0] * vy, 1.0 - even[1] * (vx * vx + vy * vy))
    along = about[0] * vx + about[1] * vy
    g = even[2] * along + even[1] * about[2]
    steeper = -(even[3] - 3.0 * even[4]) * along + 2.0 * own[2] * about[2]
    gx, gy = vx * steeper + even[2] * about[0], vy * steeper + even[2] * about[1]
    # The end moves by omega x end + v.
    ex = cross(add(by_x[1], cross(by_x[0], end)), f)
    ey = cross(add(by_y[1], cross(by_y[0], end)), f)
    el = cross(stretch, f)
    scratch[4, 0] = -vy * gx - dot(ex, by_x[0]) + xx
    scratch[4, 1] = -g - vy * gy - dot(ey, by_x[0]) + xy
    scratch[5, 0] = g + vx * gx - dot(ex, by_y[0]) + xy
    scratch[5, 1] = vx * gy - dot(ey, by_y[0]) + yy
    scratch[4, 3] = xl - dot(el, by_x[0])
    scratch[5, 3] = yl - dot(el, by_y[0])
    scratch[6, 0] = dot(about, cross(by_x[0], axis)) - dot(ex, axis)
    scratch[6, 1] = dot(about, cross(by_y[0], axis)) - dot(ey, axis)
    scratch[6, 3] = -dot(el, axis)
    scratch[7, 0], scratch[7, 1] = xl, yl
    for i in range(4):
        scratch[4 + i, 2] = 0.0
    scratch[7, 3] = 0.0


def stiffness_of(arcs: Array, k: int, i: int) -> float:
    """Stiffness of one coordinate of an arc, infinite for a rigid one."""
    return float(arcs[k, max(0, i - 1)])


def _invert_pivot(arcs: Array, k: int, more: float, stages: Array, scratch: Array) -> int:
    """Invert the pivot of arc k, with `more` of its stiffness on top; return how many are negative.

    What is rigid has a row and a column of zero in the inverse. `scratch` (11, 12) as `_fill_pivot` left it.
    """
    A = scratch[:4, :4]
    inverse = scratch[4:8]
    for i in range(4):
        rigid = stiffness_of(arcs, k, i) >= t.RIGID
        for j in range(4):
            inverse[i, j] = 0.0 if rigid or stiffness_of(arcs, k, j) >= t.RIGID else A[i, j]
            inverse[i, 4 + j] = 0.0
        inverse[i, i] = 1.0 if rigid else A[i, i] + more * stiffness_of(arcs, k, i)
        inverse[i, 4 + i] = 0.0 if rigid else 1.0
    low = 0
    for i in range(4):
        rigid = stiffness_of(arcs, k, i) >= t.RIGID
        pivot = inverse[i, i]
        low += int(not rigid and pivot <= -NEUTRAL * stiffness_of(arcs, k, i))
        over = 1.0 / pivot if pivot != 0.0 else 0.0
        for j in range(8):
            inverse[i, j] *= over
        for m in range(4):
            if m != i:
                factor = inverse[m, i]
                for j in range(8):
                    inverse[m, j] -= factor * inverse[i, j]
    for i in range(4):
        for j in range(4):
            stages[k, t.INVERSE + 4 * i + j] = inverse[i, 4 + j]
    return low


def _pass_to_arc_before(k: int, weight: Vec, P: Array, stages: Array, scratch: Array) -> None:
    """Fill how arc k answers twists of its beginning, and turn `P` (3, 6) into that of the arc before.

    `scratch` (11, 12) as `_fill_pivot` left it.
    """
    for c in range(3):
        i = c if c < 2 else t.LENGTH
        column = get_vec(stages, k, t.CENTER_COLUMNS + 3 * c)
        pushed = cross(column, weight)
        for j in range(3):
            scratch[i, 4 + j] += pushed[j]
        put_vec(stages, k, t.PUSH + 3 * i, add(get_vec(stages, k, t.PUSH + 3 * i), pushed))
    for i in range(4):
        for j in range(6):
            total = 0.0
            for m in range(4):
                total += stages[k, t.INVERSE + 4 * i + m] * scratch[m, 4 + j]
            stages[k, t.FEEDBACK + 6 * i + j] = total
    for i in range(3):
        for j in range(6):
            total = 0.0
            for m in range(4):
                total += stages[k, t.PUSH + 3 * m + i] * stages[k, t.FEEDBACK + 6 * m + j]
            P[i, j] += total
    _add_load_stiffness(P, get_vec(stages, k, t.ARC_CENTER), weight)


def impose_rigid_changes(given: Array, stages: Array, wanted: Array) -> None:
    """Take off `wanted` (N, 4) what the changes `given` (N, 4) of rigid coordinates do to their own arcs.

    They are 0 of coordinates that are not rigid.
    """
    for k in range(stages.shape[0]):
        for j in range(4):
            if given[k, j] != 0.0:
                for i in range(4):
                    wanted[k, i] -= stages[k, t.PIVOT + 4 * i + j] * given[k, j]


def solve(wanted: Array, given: Array, stages: Array, out: Array) -> None:
    """Fill `out` (N, 4) with the change of state that changes residuals by `wanted` (N, 4), in two sweeps.

    What is rigid changes as `given` (N, 4) says, see `impose_rigid_changes`. `wanted` and `out` may be the same.
    """
    sx = sy = sz = 0.0
    for k in range(stages.shape[0] - 1, -1, -1):
        for i in range(4):
            omega = get_vec(stages, k, t.TWIST_COLUMNS + 6 * i)
            out[k, i] = wanted[k, i] + omega[0] * sx + omega[1] * sy + omega[2] * sz
        a, b, c, d = out[k, 0], out[k, 1], out[k, 2], out[k, 3]
        for i in range(4):
            row = t.INVERSE + 4 * i
            out[k, i] = given[k, i] + (
                stages[k, row] * a + stages[k, row + 1] * b + stages[k, row + 2] * c + stages[k, row + 3] * d
            )
        for i in range(4):
            push = get_vec(stages, k, t.PUSH + 3 * i)
            sx, sy, sz = sx + out[k, i] * push[0], sy + out[k, i] * push[1], sz + out[k, i] * push[2]
    omega, v = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(stages.shape[0]):
        for i in range(4):
            back = get_vec(stages, k, t.FEEDBACK + 6 * i)
            out[k, i] += dot(back, omega) + dot(get_vec(stages, k, t.FEEDBACK + 6 * i + 3), v)
        omega, v = move(k, out, omega, v, stages)


def move(k: int, change: Array, omega: Vec, v: Vec, stages: Array) -> Wrench:
    """The twist of the end of arc k, from that of its beginning and a `change` (N, 4) of states."""
    for i in range(4):
        moved, column = change[k, i], t.TWIST_COLUMNS + 6 * i
        omega = add_scaled(omega, moved, get_vec(stages, k, column))
        v = add_scaled(v, moved, get_vec(stages, k, column + 3))
    return omega, v
