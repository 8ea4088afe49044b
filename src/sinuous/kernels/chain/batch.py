"""Kinematics of many configurations at once: what `Robot` offers, compiled."""

from sinuous.kernels.chain.kinematics import body_point, forward, forward_with_columns, frame, put_base
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array, add, cross, get_vec, mat_vec, put_vec, sub


@entry
def frames_of(limits: Array, q: Array, base: Array, out: Array) -> None:
    """Fill `out` (m, n + 1, 12) with the frames of all configurations `q` (m, n, 3)."""
    for i in range(q.shape[0]):
        put_base(out[i], base)
        forward(limits, q[i], out[i])


@entry
def points_of(q: Array, frames: Array, samples: int, out: Array) -> None:
    """Fill `out` (m, n * samples + 1, 3) with points of the backbone, `samples` a segment, evenly by arc length."""
    for i in range(q.shape[0]):
        put_vec(out[i], 0, 0, frame(frames[i], 0)[1])
        for k in range(q.shape[1]):
            for j in range(samples):
                put_vec(out[i], k * samples + j + 1, 0, body_point(q[i], frames[i], k, (j + 1) / samples))


@entry
def jacobians_of(limits: Array, q: Array, frames: Array, tool: Array, segment: int, columns: Array, out: Array) -> None:
    """Fill `out` (m, 6, 3 n): angular velocity, and velocity of the end of `segment` (with the tool at the tip).

    Of configurations `q` (m, n, 3) with `frames` (m, n + 1, 12); `columns` (n, 18) is scratch.
    """
    n = q.shape[1]
    for i in range(q.shape[0]):
        origin = frame(frames[i], 0)[1]
        forward_with_columns(limits, q[i], frames[i], columns)
        rotation, point = frame(frames[i], segment + 1)
        if segment == n - 1:
            point = add(point, mat_vec(rotation, get_vec(tool, 0, 9)))
        arm = sub(point, origin)
        for k in range(segment + 1):
            for c in range(3):
                omega = get_vec(columns, k, 6 * c)
                v = add(get_vec(columns, k, 6 * c + 3), cross(omega, arm))
                for r in range(3):
                    out[i, r, 3 * k + c] = omega[r]
                    out[i, r + 3, 3 * k + c] = v[r]
