"""The whole robot: segments one after the other.

Layouts, all float64 and C-contiguous:

- `q` (n, 3): bend_x, bend_y, length of every segment;
- `limits` (n, 35): rows of the segments, and of the joints and links before them, see `tables`;
- `frames` (n + 1, 12): rotation (row by row) and position of the base, and of every segment's end, in the world; of a
  joint or a link, of where the next row begins;
- `columns` (n, 18): three twists `(omega, v)` a segment, one for each coordinate: how the world beyond the segment
  moves, in world axes, about the base (`origin`).
"""

import math

import numpy as np

from sinuous.kernels.chain.arc import Twist, carry, coefficients, point, pose, pose_and_columns
from sinuous.kernels.compile import apart
from sinuous.kernels.maths.vectors import (
    ZERO,
    Array,
    Mat,
    Vec,
    add,
    add_scaled,
    cross,
    get_mat,
    get_vec,
    mat_mat,
    mat_vec,
    put_mat,
    put_vec,
    scale,
    sub,
    transpose,
)
from sinuous.kernels.tables import LINK, POSE_POSITION, RIGID, TAIL


def compose(rotation: Mat, position: Vec, inner_rotation: Mat, inner_position: Vec) -> tuple[Mat, Vec]:
    """The product of two poses."""
    return mat_mat(rotation, inner_rotation), add(position, mat_vec(rotation, inner_position))


def frame(frames: Array, k: int) -> tuple[Mat, Vec]:
    """Rotation and position that row `k` holds."""
    return get_mat(frames, k, 0), get_vec(frames, k, 9)


def put_frame(frames: Array, k: int, rotation: Mat, position: Vec) -> None:
    """Write rotation and position into row `k`."""
    put_mat(frames, k, 0, rotation)
    put_vec(frames, k, 9, position)


def put_base(frames: Array, base: Array) -> None:
    """Let frames begin with a base (1, 12)."""
    rotation, position = frame(base, 0)
    put_frame(frames, 0, rotation, position)


def _past_rigid(limits: Array, k: int, bend: float, length: float, rotation: Mat, position: Vec) -> tuple[Mat, Vec]:
    """The frame in which the row after a joint or a link begins, of that in which it begins.

    It is displaced along its z axis (prismatic), or bends about its y axis (revolute); the other of both is 0, but for
    rounding of those who gave it.
    """
    position = add_scaled(position, length, (rotation[0][2], rotation[1][2], rotation[2][2]))
    if bend != 0.0:
        S, G, _, _ = coefficients(bend * bend)
        sine, cosine = S * bend, 1.0 - G * bend * bend
        x, y, z = transpose(rotation)
        rotation = transpose((add_scaled(scale(cosine, x), -sine, z), y, add_scaled(scale(cosine, z), sine, x)))
    return compose(rotation, position, get_mat(limits, k, TAIL), get_vec(limits, k, TAIL + POSE_POSITION))


@apart
def _pass_rigid(limits: Array, q: Array, frames: Array, k: int) -> int:
    """Fill the frames after joints and links from row `k` on; returns the first row that is a segment."""
    rotation, position = frame(frames, k)
    while k < q.shape[0] and limits[k, RIGID] != 0.0:
        rotation, position = _past_rigid(limits, k, q[k, 0], q[k, 2], rotation, position)
        k += 1
        put_frame(frames, k, rotation, position)
    return k


def forward(limits: Array, q: Array, frames: Array) -> None:
    """Fill rows 1 to n of `frames`; row 0 holds the base."""
    k = int(np.int64(0))
    while k < q.shape[0]:
        if limits[k, RIGID] != 0.0:
            k = _pass_rigid(limits, q, frames, k)
        rotation, position = frame(frames, k)
        while k < q.shape[0] and limits[k, RIGID] == 0.0:
            turn, shift = pose(q[k, 0], q[k, 1], q[k, 2])
            rotation, position = compose(rotation, position, turn, shift)
            k += 1
            put_frame(frames, k, rotation, position)


def body_point(q: Array, frames: Array, k: int, s: float) -> Vec:
    """Position of the backbone at the fraction `s` of segment `k`."""
    rotation, position = frame(frames, k)
    if q[k, 0] == 0.0 and q[k, 1] == 0.0:  # as every link is
        return add(position, mat_vec(rotation, (0.0, 0.0, s * q[k, 2])))
    return add(position, mat_vec(rotation, point(s * q[k, 0], s * q[k, 1], s * q[k, 2])))


def place_on(q: Array, frames: Array, tail: float, k: int, s: float) -> Vec:
    """The same; at the ends of a segment the frames know it, so nothing is computed.

    `tail`: how far the end is from where the next row begins, see `tables.TAIL_LENGTH`.
    """
    if s <= 0.0:
        return frame(frames, k)[1]
    return frame(frames, k + 1)[1] if s >= 1.0 and tail == 0.0 else body_point(q, frames, k, s)


def tangent(q: Array, frames: Array, k: int, s: float) -> Vec:
    """Unit tangent of the backbone at the fraction `s` of segment `k`, towards the tip."""
    bend = math.hypot(q[k, 0], q[k, 1])
    aside = math.sin(s * bend) / bend if bend > 0.0 else 0.0
    return mat_vec(frame(frames, k)[0], (aside * q[k, 0], aside * q[k, 1], math.cos(s * bend)))


def body_columns(q: Array, frames: Array, origin: Vec, k: int, s: float) -> tuple[Twist, Twist, Twist]:
    """Spatial Jacobian of the backbone at the fraction `s` of segment `k`, in the three coordinates of that segment.

    A fraction of an arc is the arc of the scaled twist, so its columns are those of `s q`, times `s`.
    """
    rotation, position = frame(frames, k)
    _, _, x, y, stretch = pose_and_columns(s * q[k, 0], s * q[k, 1], s * q[k, 2])
    arm = sub(position, origin)
    return (carry(rotation, arm, x[0], x[1]), carry(rotation, arm, y[0], y[1]), (ZERO, mat_vec(rotation, stretch)))


def forward_with_columns(limits: Array, q: Array, frames: Array, columns: Array) -> None:
    """Fill rows 1 to n of `frames`, and `columns` for the ends of all segments, about the base."""
    origin = frame(frames, 0)[1]
    k = int(np.int64(0))
    while k < q.shape[0]:
        if limits[k, RIGID] != 0.0:
            k = _pass_rigid_with_columns(limits, q, frames, columns, k)
        rotation, position = frame(frames, k)
        while k < q.shape[0] and limits[k, RIGID] == 0.0:
            turn, shift, x, y, stretch = pose_and_columns(q[k, 0], q[k, 1], q[k, 2])
            arm = sub(position, origin)
            x, y = carry(rotation, arm, x[0], x[1]), carry(rotation, arm, y[0], y[1])
            put_vec(columns, k, 0, x[0])
            put_vec(columns, k, 3, x[1])
            put_vec(columns, k, 6, y[0])
            put_vec(columns, k, 9, y[1])
            put_vec(columns, k, 12, ZERO)
            put_vec(columns, k, 15, mat_vec(rotation, stretch))
            rotation, position = compose(rotation, position, turn, shift)
            k += 1
            put_frame(frames, k, rotation, position)


@apart
def _pass_rigid_with_columns(limits: Array, q: Array, frames: Array, columns: Array, k: int) -> int:
    """The same as `_pass_rigid`, with columns: of its bend about the y axis, none across that, and of its length."""
    origin = frame(frames, 0)[1]
    rotation, position = frame(frames, k)
    while k < q.shape[0] and limits[k, RIGID] != 0.0:
        if limits[k, RIGID] != LINK:
            axis = (rotation[0][1], rotation[1][1], rotation[2][1])
            put_vec(columns, k, 0, axis)
            put_vec(columns, k, 3, cross(sub(position, origin), axis))
        else:
            put_vec(columns, k, 0, ZERO)
            put_vec(columns, k, 3, ZERO)
        put_vec(columns, k, 6, ZERO)
        put_vec(columns, k, 9, ZERO)
        put_vec(columns, k, 12, ZERO)
        put_vec(columns, k, 15, (rotation[0][2], rotation[1][2], rotation[2][2]))
        rotation, position = _past_rigid(limits, k, q[k, 0], q[k, 2], rotation, position)
        k += 1
        put_frame(frames, k, rotation, position)
    return k


def interpolate(begin: Array, end: Array, fraction: float, out: Array) -> None:
    """Fill `out` (r, c) with the table that is this fraction of the way from `begin` (r, c) to `end` (r, c)."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = (1.0 - fraction) * begin[i, j] + fraction * end[i, j]


def shorten(begin: Array, end: Array, fraction: float) -> None:
    """Leave this fraction of the way from `begin` (n, 3) to `end` (n, 3), which becomes its new end."""
    for k in range(end.shape[0]):
        for i in range(3):
            end[k, i] = begin[k, i] + fraction * (end[k, i] - begin[k, i])
