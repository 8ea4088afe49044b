"""A row of the step that one place within the body has along one direction: of a contact, or of a pull to a route."""

from sinuous.kernels.chain.kinematics import body_columns, frame
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array, Vec, cross, dot, put_vec, sub
from sinuous.kernels.step.sweeps import Rows

Place = tuple[int, float, Vec]
"""A place of the backbone: segment, fraction of it, and where that is."""


@kernel
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
