"""The ends of segments of a body of arcs: where they are, what rows see of them, and where a drive takes the body."""

from sinuous.kernels.body.rows import Rows
from sinuous.kernels.chain.kinematics import frame, put_frame
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, dot, get_vec
from sinuous.kernels.statics import layout as t
from sinuous.kernels.statics.newton import copy_state
from sinuous.kernels.statics.sweeps import move


def put_ends(sections: Array, frames: Array, ends: Array) -> None:
    """Fill `ends` (n + 1, 12), frames of the base and of the ends of segments, from those of arcs (N + 1, 12)."""
    k, n = 0, sections.shape[0]
    for s in range(n + 1):
        rotation, position = frame(frames, k)
        put_frame(ends, s, rotation, position)
        k += int(sections[min(s, n - 1), t.ARC_COUNT])


def differentiate_ends(
    sections: Array, change: Array, stages: Array, rows: Rows, j: int, seen: Array
) -> tuple[Vec, Vec]:
    """Fill column `j` of what rows see, `seen` (r, 3 n), of the `change` (N, 4) of states by one coordinate.

    Returns the twist of the last end.
    """
    omega, velocity, k = ZERO, ZERO, 0
    for s in range(sections.shape[0]):
        for _ in range(int(sections[s, t.ARC_COUNT])):
            omega, velocity = move(k, change, omega, velocity, stages)
            k += 1
        for i in range(rows.start[s], rows.start[s + 1]):
            seen[i, j] = dot(get_vec(rows.twist, i, 0), omega) + dot(get_vec(rows.twist, i, 3), velocity)
    return omega, velocity


def predict_state(
    begin: tuple[Array, Array, Array], slopes: tuple[Array, Array], q: Array, x: Array, tensions: Array
) -> None:
    """Fill states `x` (N, 4) and `tensions` (t,) of a drive `q` (n, 3), to first order.

    `begin`: the drive, states and tensions of an equilibrium; `slopes` (3 n, N, 4), (3 n, t) as
    `drive.differentiate_by_drive` fills them there.
    """
    at, states, pulls = begin
    columns, by_drive = slopes
    copy_state(states, pulls, x, tensions)
    for j in range(columns.shape[0]):
        moved = q[j // 3, j % 3] - at[j // 3, j % 3]
        if moved != 0.0:
            for k in range(x.shape[0]):
                for c in range(t.STATE_WIDTH):
                    x[k, c] += moved * columns[j, k, c]
            for i in range(tensions.shape[0]):
                tensions[i] += moved * by_drive[j, i]
