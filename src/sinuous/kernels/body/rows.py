"""The rows of a step: linear constraints on the motion of the body, and the one that a single place of it has."""

from collections import namedtuple

from sinuous.kernels.chain.kinematics import body_columns, frame
from sinuous.kernels.maths.buffers import cut, cut_whole
from sinuous.kernels.maths.vectors import Array, Vec, cross, dot, put_vec, sub

Rows = namedtuple("Rows", ["start", "kind", "twist", "inner", "total", "value", "gain", "innovation"])
"""The constraints `a . x + b . z = value` of a step, see `step.sweeps`, in the order of their segments.

`start` (n + 1,): rows `start[k]` to `start[k + 1]` belong to segment k. `kind` (m,): END, at the end of the segment
(these come last in it); INNER, within the body; SOFT, the same but a wish; HARD, met exactly whatever `mu`; IDLE,
left out. `twist` (m, 6) is `a`, seen from the end of the segment; `inner` (m, 3) is `b` in the coordinates of `q_k`,
for INNER and HARD; `total` (m, 3) weighs the sum of all `dq` up to this segment, for HARD: actuators that run through
several segments see no more than that. Any other row `c . dq` is added after the sweeps, see `step.coupling`. `value`
(m,). The sweeps fill `gain` (m, 13), whose last is the inverse of the variance, and `innovation` (m,).
"""

END, INNER, HARD, IDLE, SOFT = 0, 1, 2, 3, 4

Place = tuple[int, float, Vec]
"""A place of the backbone: segment, fraction of it, and where that is."""


def rows_size(segments: int, capacity: int) -> int:
    """Numbers that one set of rows takes from a buffer."""
    return segments + 1 + 28 * capacity


def carve_rows(buffer: Array, count: int, segments: int, capacity: int) -> Rows:
    """Lay out `count` sets of rows in the beginning of `buffer`; every array has one more axis in front."""
    start, rest = cut_whole(buffer, count, segments + 1)
    kind, rest = cut_whole(rest, count, capacity)
    twist, rest = cut(rest, count, capacity, 6)
    inner, rest = cut(rest, count, capacity, 3)
    total, rest = cut(rest, count, capacity, 3)
    value, rest = cut(rest, count, capacity)
    gain, rest = cut(rest, count, capacity, 13)
    innovation, rest = cut(rest, count, capacity)
    return Rows(start, kind, twist, inner, total, value, gain, innovation)


def pick_rows(rows: Rows, i: int) -> Rows:
    """Set number `i` of several."""
    return Rows(
        rows.start[i],
        rows.kind[i],
        rows.twist[i],
        rows.inner[i],
        rows.total[i],
        rows.value[i],
        rows.gain[i],
        rows.innovation[i],
    )


def put_body_row(
    rows: Rows, at: int, q: Array, frames: Array, place: Place, force: Vec, kind: int, value: float
) -> int:
    """Write row `at`, of kind INNER or SOFT: `force . (motion of the place) = value`; returns the next free row.

    The place moves with the world beyond its segment, but for what the rest of the segment adds to that.
    """
    k, s, p = place
    origin = frame(frames, 0)[1]
    torque = cross(sub(p, origin), force)
    x, y, z = body_columns(q, frames, origin, k, s)
    end = body_columns(q, frames, origin, k, 1.0)
    put_vec(rows.twist, at, 0, torque)
    put_vec(rows.twist, at, 3, force)
    rows.inner[at, 0] = s * (dot(torque, x[0]) + dot(force, x[1])) - dot(torque, end[0][0]) - dot(force, end[0][1])
    rows.inner[at, 1] = s * (dot(torque, y[0]) + dot(force, y[1])) - dot(torque, end[1][0]) - dot(force, end[1][1])
    rows.inner[at, 2] = s * dot(force, z[1]) - dot(force, end[2][1])
    rows.kind[at] = kind
    rows.value[at] = value
    return at + 1
