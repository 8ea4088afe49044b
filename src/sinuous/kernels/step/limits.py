"""The limits of one segment, held exactly: length in [low, high], bend at most `max_bend` and `max_curvature * length`.

Row k of `limits` (n, 18) is that of segment k, see `tables`: its limits, its radii, and the scales of a bend (rad) and
of a length in which motion is measured (0: that coordinate cannot move).
"""

import math

from sinuous.kernels.maths.vectors import Array, Vec, get_vec, put_mat, put_vec
from sinuous.kernels.tables import BEND_SCALE, LENGTH_SCALE, MAX_BEND, MAX_CURVATURE, MAX_LENGTH, MIN_LENGTH


def bend_cap(limits: Array, k: int, length: float) -> float:
    """Largest bend of segment `k` at this length."""
    # In this order: without a limit of curvature the product at length 0 is NaN, and `min` keeps its first argument.
    return min(limits[k, MAX_BEND], limits[k, MAX_CURVATURE] * length)


def bend_of(ux: float, uy: float) -> float:
    """Angle of an arc: a call of `hypot`, which guards numbers that bends never are, takes longer than its segment."""
    return math.sqrt(ux * ux + uy * uy)


def project_segment(limits: Array, k: int, ux: float, uy: float, length: float) -> Vec:
    """Bring one segment within its limits; what is within them already stays as it is."""
    length = min(max(length, limits[k, MIN_LENGTH]), limits[k, MAX_LENGTH])
    cap = bend_cap(limits, k, length)
    bend = bend_of(ux, uy)
    if bend > cap:
        shrink = cap / bend
        return ux * shrink, uy * shrink, length
    return ux, uy, length


def move(limits: Array, q: Array, step: Array, out: Array) -> None:
    """out = q + step, within all limits."""
    for k in range(q.shape[0]):
        put_vec(out, k, 0, project_segment(limits, k, q[k, 0] + step[k, 0], q[k, 1] + step[k, 1], q[k, 2] + step[k, 2]))


def release(limits: Array, root: Array, bound: Array) -> None:
    """Let every segment move in all its coordinates."""
    for k in range(limits.shape[0]):
        bend, stretch = limits[k, BEND_SCALE], limits[k, LENGTH_SCALE]
        put_mat(root, k, 0, ((bend, 0.0, 0.0), (0.0, bend, 0.0), (0.0, 0.0, stretch)))
        bound[k] = 0


def bind(limits: Array, q: Array, step: Array, root: Array, mean: Array, bound: Array) -> int:
    """Take out of the step what leaves the limits: move up to the bound, then only along it, as `mean` wishes there.

    In the half-plane of the bend (along the direction that the step bends to) and the length, the limits of a segment
    are a convex polygon; the bend across stays free. `bound[k]` collects what is bound: 1 the length, 2 the bend.
    Returns how many segments were bound anew.
    """
    count = 0
    for k in range(q.shape[0]):
        aim = (q[k, 0] + step[k, 0], q[k, 1] + step[k, 1], q[k, 2] + step[k, 2])
        length = min(max(aim[2], limits[k, MIN_LENGTH]), limits[k, MAX_LENGTH])
        now = bound[k]
        if abs(aim[2] - length) > 1e-12 * (1.0 + length):
            now |= 1
        if bend_of(aim[0], aim[1]) > bend_cap(limits, k, length) + 1e-12:
            now |= 2
        if now != bound[k]:
            bound[k] = now
            _bind_one(limits, q, k, aim, root, mean, now)
            count += 1
    return count


def _bind_one(limits: Array, q: Array, k: int, aim: Vec, root: Array, mean: Array, bound: int) -> None:
    scale, stretch = limits[k, BEND_SCALE], limits[k, LENGTH_SCALE]
    length = aim[2]
    if bound & 1:
        length = min(max(length, limits[k, MIN_LENGTH]), limits[k, MAX_LENGTH])
        stretch = 0.0
    wish = get_vec(mean, k, 0)
    if bound == 1:
        put_mat(root, k, 0, ((scale, 0.0, 0.0), (0.0, scale, 0.0), (0.0, 0.0, 0.0)))
        put_vec(mean, k, 0, (wish[0], wish[1], length - q[k, 2]))
        return
    bend = bend_of(aim[0], aim[1])
    nx, ny = (aim[0] / bend, aim[1] / bend) if bend > 0.0 else (1.0, 0.0)
    along = nx * q[k, 0] + ny * q[k, 1]
    across = nx * wish[1] - ny * wish[0]
    cap = bend_cap(limits, k, length)
    if cap < limits[k, MAX_BEND] and scale * stretch > 0.0:
        # The slanted edge bend = c * length: straight across to it, then free along it.
        c = limits[k, MAX_CURVATURE]
        gap = (c * q[k, 2] - along) / (scale * scale + (c * stretch) ** 2)
        e = 1.0 / math.sqrt((c / scale) ** 2 + 1.0 / stretch**2)
        put_mat(root, k, 0, ((-ny * scale, nx * c * e, 0.0), (nx * scale, ny * c * e, 0.0), (0.0, e, 0.0)))
        slide = e * e * (c * (nx * wish[0] + ny * wish[1]) / scale**2 + wish[2] / stretch**2)
        out = gap * scale**2 + slide * c
        put_vec(mean, k, 0, (nx * out - ny * across, ny * out + nx * across, slide - gap * c * stretch**2))
        return
    out = cap - along
    put_mat(root, k, 0, ((-ny * scale, 0.0, 0.0), (nx * scale, 0.0, 0.0), (0.0, 0.0, stretch)))
    rise = length - q[k, 2] if bound & 1 else wish[2]
    put_vec(mean, k, 0, (nx * out - ny * across, ny * out + nx * across, rise))
