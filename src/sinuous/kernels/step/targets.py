"""Targets as rows of the step, and their errors.

Row i of `targets` (t, 15): segment whose end it concerns (from 0; -1 the last), 1 if a position is asked for,
position (3), what is asked of the orientation (0 nothing, 1 a direction of the tangent, 2 a rotation), direction (3,
then six unused) or rotation (9).
"""

import math

from sinuous.kernels import tables as t
from sinuous.kernels.body.rows import END, Rows
from sinuous.kernels.chain.kinematics import compose, frame
from sinuous.kernels.maths.vectors import (
    ZERO,
    Array,
    Mat,
    Vec,
    across,
    cross,
    dot,
    get_mat,
    get_vec,
    mat_mat,
    mat_vec,
    norm,
    put_vec,
    scale,
    sub,
    transpose,
)
from sinuous.kernels.problem import Problem

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def end_segment(targets: Array, i: int, segments: int) -> int:
    """The segment, from 0, whose end target `i` concerns."""
    k = int(targets[i, t.TARGET_SEGMENT])
    return k if k >= 0 else segments - 1


def distal_target(targets: Array, segments: int) -> int:
    """Number of the most distal target that has a position; of several, the last; -1: none has."""
    found = tip = -1
    for i in range(targets.shape[0]):
        k = end_segment(targets, i, segments)
        if targets[i, t.HAS_POSITION] != 0.0 and k >= tip:
            found, tip = i, k
    return found


def tangent_back(targets: Array, i: int) -> Vec:
    """Where the backbone comes from at the target; zero where it may come from anywhere."""
    if targets[i, t.ORIENTATION] == t.FREE:
        return ZERO
    if targets[i, t.ORIENTATION] == t.DIRECTION:
        return scale(-1.0, get_vec(targets, i, t.GOAL))
    return (-targets[i, t.GOAL + 2], -targets[i, t.GOAL + 5], -targets[i, t.GOAL + 8])


def backbone_end(problem: Problem, i: int, k: int) -> tuple[Vec, float]:
    """Where target `i` puts the end of its segment, and how far it may be from there because the tool can turn."""
    place = get_vec(problem.targets, i, t.TARGET_POSITION)
    if k < problem.limits.shape[0] - 1:
        return place, 0.0
    offset, shift = frame(problem.tool, 0)
    if norm(shift) == 0.0:
        return place, 0.0
    if problem.targets[i, t.ORIENTATION] != t.ROTATION:
        return place, norm(shift)
    row = problem.targets
    goal = (get_vec(row, i, t.GOAL), get_vec(row, i, t.GOAL + 3), get_vec(row, i, t.GOAL + 6))
    turned = mat_vec(goal, mat_vec(transpose(offset), shift))
    return sub(place, turned), min(2.0, problem.angle_tolerance) * norm(shift)


def end_pose(frames: Array, tool: Array, k: int) -> tuple[Mat, Vec]:
    """Pose of the end of segment `k`; at the tip, of the tool."""
    rotation, position = frame(frames, k + 1)
    if k == frames.shape[0] - 2:
        offset, shift = frame(tool, 0)
        return compose(rotation, position, offset, shift)
    return rotation, position


def rotation_vector(m: Mat) -> Vec:
    """Logarithm of a rotation matrix, angle in [0, pi]."""
    w = (0.5 * (m[2][1] - m[1][2]), 0.5 * (m[0][2] - m[2][0]), 0.5 * (m[1][0] - m[0][1]))
    sine, cosine = norm(w), 0.5 * (m[0][0] + m[1][1] + m[2][2] - 1.0)
    angle = math.atan2(sine, cosine)
    if sine > 1e-4 or (cosine > 0.0 and sine > 1e-10):
        return scale(angle / sine, w)
    if cosine > 0.0:
        return w
    # Near a half turn the sine is too small to divide by. (R + R') / 2 - cos I = (1 - cos) n n': the longest column.
    x = (m[0][0] - cosine, 0.5 * (m[1][0] + m[0][1]), 0.5 * (m[2][0] + m[0][2]))
    y = (x[1], m[1][1] - cosine, 0.5 * (m[2][1] + m[1][2]))
    z = (x[2], y[2], m[2][2] - cosine)
    axis = x
    if y[1] > axis[0] and y[1] >= z[2]:
        axis = y
    elif z[2] > axis[0]:
        axis = z
    sign = -1.0 if dot(axis, w) < 0.0 else 1.0
    return scale(sign * angle / norm(axis), axis)


def direction_vector(tangent: Vec, goal: Vec) -> Vec:
    """The shortest rotation that takes one unit vector to the other, as a rotation vector."""
    w = cross(tangent, goal)
    sine, cosine = norm(w), dot(tangent, goal)
    if sine > 1e-14:
        return scale(math.atan2(sine, cosine) / sine, w)
    return w if cosine > 0.0 else scale(math.pi, across(tangent)[0])


def put_row(rows: Rows, at: int, turn: Vec, move: Vec, value: float) -> int:
    """Write row `at`, `turn . omega + move . v = value` at the end of a segment; returns the next free row."""
    put_vec(rows.twist, at, 0, turn)
    put_vec(rows.twist, at, 3, move)
    rows.kind[at] = END
    rows.value[at] = value
    return at + 1


def add_rows(
    targets: Array, i: int, frames: Array, tool: Array, origin: Vec, unit: float, rows: Rows, at: int
) -> tuple[int, float, float]:
    """Write the rows of target `i` from row `at` on, lengths in units of `unit`.

    Returns the next free row, the position error (length) and the angle error (rad); zero where nothing is asked.
    """
    rotation, position = end_pose(frames, tool, end_segment(targets, i, frames.shape[0] - 1))
    miss, turn = ZERO, ZERO
    if targets[i, t.HAS_POSITION] != 0.0:
        inverse = 1.0 / unit
        miss = sub(get_vec(targets, i, t.TARGET_POSITION), position)
        arm = scale(inverse, sub(position, origin))
        at = put_row(rows, at, cross(arm, X), scale(inverse, X), inverse * miss[0])
        at = put_row(rows, at, cross(arm, Y), scale(inverse, Y), inverse * miss[1])
        at = put_row(rows, at, cross(arm, Z), scale(inverse, Z), inverse * miss[2])
    if targets[i, t.ORIENTATION] == t.ROTATION:
        turn = rotation_vector(mat_mat(get_mat(targets, i, t.GOAL), transpose(rotation)))
        at = put_row(rows, at, X, ZERO, turn[0])
        at = put_row(rows, at, Y, ZERO, turn[1])
        at = put_row(rows, at, Z, ZERO, turn[2])
    elif targets[i, t.ORIENTATION] == t.DIRECTION:
        tangent = (rotation[0][2], rotation[1][2], rotation[2][2])
        turn = direction_vector(tangent, get_vec(targets, i, t.GOAL))
        a, b = across(tangent)
        at = put_row(rows, at, a, ZERO, dot(turn, a))
        at = put_row(rows, at, b, ZERO, dot(turn, b))
    return at, norm(miss), norm(turn)


def miss_of(targets: Array, i: int, rotation: Mat, position: Vec) -> tuple[Vec, Vec]:
    """How far the end of a segment at this pose is from target `i`, and the rotation (rad) that is missing.

    Zero where nothing is asked. `add_rows`, which every step passes, has it written out: answers keep their last digit.
    """
    miss, turn = ZERO, ZERO
    if targets[i, t.HAS_POSITION] != 0.0:
        miss = sub(get_vec(targets, i, t.TARGET_POSITION), position)
    if targets[i, t.ORIENTATION] == t.ROTATION:
        turn = rotation_vector(mat_mat(get_mat(targets, i, t.GOAL), transpose(rotation)))
    elif targets[i, t.ORIENTATION] == t.DIRECTION:
        turn = direction_vector((rotation[0][2], rotation[1][2], rotation[2][2]), get_vec(targets, i, t.GOAL))
    return miss, turn
