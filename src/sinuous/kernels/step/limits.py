"""The limits of one segment, held exactly: length in [low, high], bend at most `max_bend` and `max_curvature * length`.

Where a segment bends in one plane, its bend is `rest + z plane` with z between two limits; where its bend is locked,
both are the same. Row k of `limits` (n, 35) is that of segment k, see `tables`: its limits, its radii, and the scales
of a bend (rad) and of a length in which motion is measured (0: that coordinate cannot move).

`step` (n, 3) is a motion, `out` (n, 3) a configuration; `mean` (n, 3) a motion that is decided beforehand, and `bound`
(n,) int64 what of each segment is bound, see `sweeps` and `bind`.
"""

import math

from sinuous.kernels.compile import apart
from sinuous.kernels.maths.vectors import Array, Mat, Vec, get_vec, put_mat, put_vec
from sinuous.kernels.tables import (
    BEND_SCALE,
    HIGH_BEND,
    IN_PLANE,
    LENGTH_SCALE,
    LOW_BEND,
    MAX_BEND,
    MAX_CURVATURE,
    MAX_LENGTH,
    MIN_LENGTH,
    PLANE,
    REST,
    RIGID,
)


def bend_cap(limits: Array, k: int, length: float) -> float:
    """Largest bend of segment `k` at this length."""
    # In this order: without a limit of curvature the product at length 0 is NaN, and `min` keeps its first argument.
    return min(limits[k, MAX_BEND], limits[k, MAX_CURVATURE] * length)


def length_range(limits: Array) -> tuple[float, float]:
    """Least and greatest length of all segments together."""
    low = high = 0.0
    for k in range(limits.shape[0]):
        low += limits[k, MIN_LENGTH]
        high += limits[k, MAX_LENGTH]
    return low, high


def middle_length(limits: Array, k: int) -> float:
    """Mean of the least and the largest length of row `k`."""
    return 0.5 * float(limits[k, MIN_LENGTH] + limits[k, MAX_LENGTH])


def bend_of(ux: float, uy: float) -> float:
    """Angle of an arc: a call of `hypot`, which guards numbers that bends never are, takes longer than its segment."""
    return math.sqrt(ux * ux + uy * uy)


def bends_in_plane(limits: Array, k: int) -> bool:
    """Whether segment `k` bends in one plane, or is locked."""
    return bool(limits[k, IN_PLANE] != 0.0)


def in_plane(limits: Array, k: int, ux: float, uy: float) -> float:
    """What a bend, or a motion of it, has along the plane of segment `k`."""
    return float(ux * limits[k, PLANE] + uy * limits[k, PLANE + 1])


def plane_bend(limits: Array, k: int, z: float) -> tuple[float, float]:
    """The bend `z` in the plane of segment `k`."""
    return limits[k, REST] + z * limits[k, PLANE], limits[k, REST + 1] + z * limits[k, PLANE + 1]


def curved_bend(limits: Array, k: int, length: float) -> tuple[float, float]:
    """Largest bend in the plane of segment `k` that its curvature allows at this length, and how it grows with it."""
    most = limits[k, MAX_CURVATURE]
    if not most < math.inf:
        return math.inf, 0.0
    off = limits[k, REST] ** 2 + limits[k, REST + 1] ** 2
    if off == 0.0:
        return most * length, most
    bend = math.sqrt(max(0.0, (most * length) ** 2 - off))
    return bend, most * most * length / bend if bend > 0.0 else 0.0


def plane_range(limits: Array, k: int, length: float) -> tuple[float, float]:
    """Least and largest bend in the plane of segment `k` at this length."""
    most, _ = curved_bend(limits, k, length)
    low, high = max(limits[k, LOW_BEND], -most), min(limits[k, HIGH_BEND], most)
    if low > high:  # by rounding, or where no length is left: what is nearest to the limits of the bend
        end = limits[k, LOW_BEND] if limits[k, LOW_BEND] > 0.0 else limits[k, HIGH_BEND]
        return end, end
    return low, high


def free_root(limits: Array, k: int) -> Mat:
    """Root of the metric of segment `k` where no limit binds it."""
    bend, stretch = limits[k, BEND_SCALE], limits[k, LENGTH_SCALE]
    if bends_in_plane(limits, k):
        x, y = bend * limits[k, PLANE], bend * limits[k, PLANE + 1]
        return (x, 0.0, 0.0), (y, 0.0, 0.0), (0.0, 0.0, stretch)
    return (bend, 0.0, 0.0), (0.0, bend, 0.0), (0.0, 0.0, stretch)


def project_segment(limits: Array, k: int, ux: float, uy: float, length: float) -> Vec:
    """Bring one segment within its limits; what is within them already stays as it is."""
    length = min(max(length, limits[k, MIN_LENGTH]), limits[k, MAX_LENGTH])
    if bends_in_plane(limits, k):
        return _project_in_plane(limits, k, ux, uy, length)
    cap = bend_cap(limits, k, length)
    bend = bend_of(ux, uy)
    if bend > cap:
        shrink = cap / bend
        return ux * shrink, uy * shrink, length
    return ux, uy, length


@apart
def _project_in_plane(limits: Array, k: int, ux: float, uy: float, length: float) -> Vec:
    """The same for a bend in one plane, at a length within its limits."""
    low, high = plane_range(limits, k, length)
    x, y = plane_bend(limits, k, min(max(in_plane(limits, k, ux, uy), low), high))
    return x, y, length


def move(limits: Array, q: Array, step: Array, out: Array) -> None:
    """out = q + step, within all limits."""
    for k in range(q.shape[0]):
        put_vec(out, k, 0, project_segment(limits, k, q[k, 0] + step[k, 0], q[k, 1] + step[k, 1], q[k, 2] + step[k, 2]))


def release(limits: Array, root: Array, mean: Array, bound: Array) -> None:
    """Let every segment move in all its coordinates, and wish for no motion across a plane."""
    for k in range(limits.shape[0]):
        bend, stretch = limits[k, BEND_SCALE], limits[k, LENGTH_SCALE]
        put_mat(root, k, 0, ((bend, 0.0, 0.0), (0.0, bend, 0.0), (0.0, 0.0, stretch)))
        bound[k] = 0
        if bends_in_plane(limits, k):
            _release_in_plane(limits, root, mean, k)


@apart
def _release_in_plane(limits: Array, root: Array, mean: Array, k: int) -> None:
    put_mat(root, k, 0, free_root(limits, k))
    x, y = _along_plane(limits, k, mean[k, 0], mean[k, 1])
    put_vec(mean, k, 0, (x, y, mean[k, 2]))


def possible_bend(limits: Array, k: int, ux: float, uy: float) -> tuple[float, float]:
    """What of the motion of a bend segment `k` can do, or of a gradient by its bend, what can change it."""
    return _along_plane(limits, k, ux, uy) if bends_in_plane(limits, k) else (ux, uy)


@apart
def _along_plane(limits: Array, k: int, ux: float, uy: float) -> tuple[float, float]:
    z = in_plane(limits, k, ux, uy) if limits[k, BEND_SCALE] > 0.0 else 0.0
    return z * limits[k, PLANE], z * limits[k, PLANE + 1]


def bind(limits: Array, q: Array, step: Array, root: Array, mean: Array, bound: Array) -> int:
    """Take out of the step what leaves the limits: move up to the bound, then only along it, as `mean` wishes there.

    In the half-plane of the bend (along the direction that the step bends to) and the length, the limits of a segment
    are a convex polygon; the bend across stays free. `bound[k]` collects what is bound: 1 the length, 2 the bend.
    Returns how many segments were bound anew.
    """
    count = 0
    for k in range(q.shape[0]):
        if bends_in_plane(limits, k):
            if limits[k, RIGID] == 0.0 or _leaves(limits, q, k, step):
                count += _bind_in_plane(limits, q, k, step, root, mean, bound)
            continue
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


def _leaves(limits: Array, q: Array, k: int, step: Array) -> bool:
    """Whether a step leaves the limits of a joint that turns, or nearly."""
    z = q[k, 0] + step[k, 0]
    return not limits[k, LOW_BEND] <= z <= limits[k, HIGH_BEND]


@apart
def _bind_in_plane(limits: Array, q: Array, k: int, step: Array, root: Array, mean: Array, bound: Array) -> int:
    """The same for a segment that bends in one plane: the limits are a polygon in the bend along it and the length."""
    aim = (q[k, 0] + step[k, 0], q[k, 1] + step[k, 1], q[k, 2] + step[k, 2])
    length = min(max(aim[2], limits[k, MIN_LENGTH]), limits[k, MAX_LENGTH])
    now = bound[k]
    if abs(aim[2] - length) > 1e-12 * (1.0 + length):
        now |= 1
    z, (low, high) = in_plane(limits, k, aim[0], aim[1]), plane_range(limits, k, length)
    if limits[k, BEND_SCALE] > 0.0 and (z < low - 1e-12 or z > high + 1e-12):
        now |= 2
    if now == bound[k]:
        return 0
    bound[k] = now
    _slide_in_plane(limits, q, k, aim, root, mean, now)
    return 1


def _slide_in_plane(limits: Array, q: Array, k: int, aim: Vec, root: Array, mean: Array, bound: int) -> None:
    scale, stretch, length = limits[k, BEND_SCALE], limits[k, LENGTH_SCALE], aim[2]
    px, py = limits[k, PLANE], limits[k, PLANE + 1]
    rise = mean[k, 2]
    if bound & 1:
        length = min(max(length, limits[k, MIN_LENGTH]), limits[k, MAX_LENGTH])
        stretch, rise = 0.0, length - q[k, 2]
    if bound == 1:
        put_mat(root, k, 0, ((scale * px, 0.0, 0.0), (scale * py, 0.0, 0.0), (0.0, 0.0, 0.0)))
        put_vec(mean, k, 0, (mean[k, 0], mean[k, 1], rise))
        return
    z, now = in_plane(limits, k, aim[0], aim[1]), in_plane(limits, k, q[k, 0], q[k, 1])
    low, high = plane_range(limits, k, length)
    cap, slope = (high, 1.0) if z > 0.5 * (low + high) else (low, -1.0)
    most, growth = curved_bend(limits, k, length)
    if scale * stretch > 0.0 and growth > 0.0 and cap == slope * most:
        c = slope * growth  # the slanted edge, as where a bend to all sides meets it
        gap = (cap + c * (q[k, 2] - length) - now) / (scale * scale + (c * stretch) ** 2)
        e = 1.0 / math.sqrt((c / scale) ** 2 + 1.0 / stretch**2)
        slide = e * e * (c * in_plane(limits, k, mean[k, 0], mean[k, 1]) / scale**2 + rise / stretch**2)
        out = gap * scale**2 + slide * c
        put_mat(root, k, 0, ((c * e * px, 0.0, 0.0), (c * e * py, 0.0, 0.0), (e, 0.0, 0.0)))
        put_vec(mean, k, 0, (out * px, out * py, slide - gap * c * stretch**2))
        return
    put_mat(root, k, 0, ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, stretch)))
    put_vec(mean, k, 0, ((cap - now) * px, (cap - now) * py, rise))


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
