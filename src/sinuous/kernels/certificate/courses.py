"""Where obstacles that move are, and how they go on, as a proof needs it: from poses at times to drifts.

`poses` (P, 17) has a row for each pose: its course, its time, and the pose; `rows` (T - 1, c, 31) and `row` (c, 31) are
drifts, see `drift`.
"""

from sinuous.kernels.certificate.drift import BEGIN, TURN, TURNED, VELOCITY
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.rotations import exponential
from sinuous.kernels.maths.vectors import (
    Array,
    Vec,
    add_scaled,
    get_mat,
    get_vec,
    mat_mat,
    put_mat,
    put_vec,
    scale,
    sub,
)

COURSE, TIME, COURSE_POSITION, COURSE_ROTATION, ONWARD = 0, 1, 2, 5, 14
"""Columns of a pose: the number of its course; its time; where the frame of the obstacle is (3), length unit; how that
is turned (9, row by row); and the rotation vector (3) to the next pose of the course, rad, in that frame."""

COURSE_POSE_WIDTH = ONWARD + 3


def _step_at(poses: Array, first: int, last: int, t: float) -> int:
    """The last pose from `first` to the one before `last` that is not later than t; `first` where there is none."""
    low, high = first, max(first, last - 1)
    while low < high:
        middle = (low + high + 1) // 2
        if poses[middle, TIME] <= t:
            low = middle
        else:
            high = middle - 1
    return low


def _share_at(poses: Array, i: int, t: float) -> float:
    """How much of the way from pose i to the next is over at t, 0 to 1."""
    begin, end = poses[i, TIME], poses[i + 1, TIME]
    return min(1.0, max(0.0, (t - begin) / (end - begin)))


def _place_at(poses: Array, i: int, fraction: float) -> Vec:
    """The place after this share of the way from pose i to the next: exactly that of a pose at its end."""
    if fraction >= 1.0:
        return get_vec(poses, i + 1, COURSE_POSITION)
    here = get_vec(poses, i, COURSE_POSITION)
    return add_scaled(scale(1.0 - fraction, here), fraction, get_vec(poses, i + 1, COURSE_POSITION))


@entry
def fill_drifts(poses: Array, times: Array, rows: Array) -> None:
    """Fill in how obstacles move from each of the `times` (T,) to the next, in none of which they pass a pose.

    `poses` (P, 17): those of all courses, one course after the other, each in the order of its times. Of `rows`
    (T - 1, c, 31), see `drift`, what moves is filled in.
    """
    first = 0
    for e in range(rows.shape[1]):
        last = first
        while last + 1 < poses.shape[0] and poses[last + 1, COURSE] == poses[first, COURSE]:
            last += 1
        for k in range(rows.shape[0]):
            _fill_drift(poses, first, last, times[k], times[k + 1], rows[k], e)
        first = last + 1


def _fill_drift(poses: Array, first: int, last: int, begin: float, end: float, row: Array, e: int) -> None:
    """Fill in how the obstacle of row e moves between two times; its poses are those from `first` to `last`."""
    turned = get_mat(poses, first, COURSE_ROTATION)
    if first == last:
        put_vec(row, e, BEGIN, get_vec(poses, first, COURSE_POSITION))
        put_vec(row, e, VELOCITY, (0.0, 0.0, 0.0))
        put_mat(row, e, TURNED, turned)
        put_vec(row, e, TURN, (0.0, 0.0, 0.0))
        return
    middle = 0.5 * (begin + end)
    i = _step_at(poses, first, last, middle)
    before, fraction, after = _share_at(poses, i, begin), _share_at(poses, i, middle), _share_at(poses, i, end)
    move = after - before if 0.0 < fraction < 1.0 else 0.0
    here, turn = _place_at(poses, i, before), get_vec(poses, i, ONWARD)
    there = _place_at(poses, i, after) if move > 0.0 else here
    put_vec(row, e, BEGIN, here)
    put_vec(row, e, VELOCITY, sub(there, here))
    put_mat(row, e, TURNED, mat_mat(get_mat(poses, i, COURSE_ROTATION), exponential(scale(before, turn))))
    put_vec(row, e, TURN, scale(move, turn))
