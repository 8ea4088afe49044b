"""Where a solve begins when nobody says: the single arc to the target, and shapes scattered over all possible ones."""

import math

import numpy as np

from sinuous.kernels.chain.kinematics import forward, frame
from sinuous.kernels.chain.single_arc import arc_to
from sinuous.kernels.maths.vectors import Array, Vec, get_vec, put_vec, sub, vec_mat
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import bend_cap, bends_in_plane, length_range, middle_length, project_segment
from sinuous.kernels.step.targets import distal_target, end_pose, end_segment
from sinuous.kernels.tables import (
    BEND_SCALE,
    HAS_POSITION,
    HIGH_BEND,
    LOW_BEND,
    MAX_LENGTH,
    MIN_LENGTH,
    PLANE,
    RIGID,
    TARGET_POSITION,
)

LONGEST_HALF_BEND = 3.0
"""Half the bend of a single arc from which on it counts as too long, in rad."""


def find_most_distal(problem: Problem) -> tuple[int, Vec]:
    """Segment and position of the most distal target that has a position (-1: none has)."""
    i = distal_target(problem.targets, problem.limits.shape[0])
    if i < 0:
        return -1, (0.0, 0.0, 0.0)
    return end_segment(problem.targets, i, problem.limits.shape[0]), get_vec(problem.targets, i, TARGET_POSITION)


def chord_angle(ratio: float) -> float:
    """Half the bend of an arc whose chord is `ratio` (0 to 1) of its length: solves sin x = ratio x."""
    if ratio >= 1.0:
        return 0.0
    # Newton from the root of the series sin x / x = 1 - x^2 / 6 + x^4 / 120 with two terms.
    x = math.sqrt(10.0 * (1.0 - math.sqrt(max(0.0, 1.0 - 1.2 * (1.0 - ratio)))))
    for _ in range(4):
        x -= (math.sin(x) - ratio * x) / (math.cos(x) - ratio)
    return x


def put_single_arc(limits: Array, frames: Array, tip: int, goal: Vec, q: Array) -> None:
    """The arc that leaves along the base's tangent and ends at `goal`; every segment up to `tip` has its share of it.

    Where the arc is shorter or longer than the robot can be, its length is the nearest that the robot has, and its
    bend the one whose chord is as long as the goal is far: this also bows the robot when the goal is straight ahead
    but too near.
    """
    first = _center_joints(limits, frames, q)
    if first > tip:
        return
    rotation, base = frame(frames, first)
    p = vec_mat(sub(goal, base), rotation)
    side = math.hypot(p[0], p[1])
    chord = math.hypot(side, p[2])
    low, high = length_range(limits[first : tip + 1])
    half, length = arc_to(side, p[2])
    if half >= LONGEST_HALF_BEND:
        length = math.inf
    if length < low or length > high:
        length = min(max(length, low), high)
        half = max(min(half, 1.6), chord_angle(min(1.0, chord / length))) if length > 0.0 else 0.0
    fraction = (length - low) / (high - low) if high > low else 0.0
    bx, by = (p[0] / side, p[1] / side) if side > 1e-9 * chord else _first_plane(limits)
    for k in range(first, q.shape[0]):
        own = limits[k, MIN_LENGTH] + fraction * (limits[k, MAX_LENGTH] - limits[k, MIN_LENGTH])
        bend = min(2.0 * half * own / length, bend_cap(limits, k, own)) if length > 0.0 else 0.0
        if k > tip:
            bend = 0.0
        ux, uy = bx * bend, by * bend
        if bends_in_plane(limits, k):
            ux, uy, own = project_segment(limits, k, ux, uy, own)
        put_vec(q, k, 0, (ux, uy, own))


def rigid_rows(limits: Array) -> int:
    """How many rows of joints and links stand before the first segment."""
    first = int(np.int64(0))
    while first < limits.shape[0] and limits[first, RIGID] != 0.0:
        first += 1
    return first


def _center_joints(limits: Array, frames: Array, q: Array) -> int:
    """Put all joints in the middle of their ranges, and return the first segment; `frames` lead there."""
    first = rigid_rows(limits)
    for k in range(first):
        bend = 0.5 * (limits[k, LOW_BEND] + limits[k, HIGH_BEND])
        put_vec(q, k, 0, (bend * limits[k, PLANE], bend * limits[k, PLANE + 1], middle_length(limits, k)))
    if first > 0:
        forward(limits[:first], q[:first], frames)
    return first


def _first_plane(limits: Array) -> tuple[float, float]:
    """The direction of the first plane that a segment bends in, or x where all bend to all sides."""
    for k in range(limits.shape[0]):
        if bends_in_plane(limits, k) and limits[k, BEND_SCALE] > 0.0:
            return limits[k, PLANE], limits[k, PLANE + 1]
    return 1.0, 0.0


def widest_bend(start: int) -> float:
    """Most bend (rad) that is drawn for scattered start `start`: half a turn if it is odd, a full turn if it is even.

    What continues an arc beyond pi leads back to the other side. Shapes that were drawn below pi are turned to the
    wrong side of such a target by `turn_to_targets`, and by symmetry no descent comes round from there.
    """
    return math.pi if start % 2 == 1 else 2.0 * math.pi


def _turn_segments(limits: Array, frames: Array, tool: Array, first: int, last: int, goal: Vec, q: Array) -> None:
    """Turn segments `first` and beyond about the tangent there until the end of `last` lies on the goal's side.

    Those that bend in one plane stay as they are.
    """
    forward(limits, q, frames)
    rotation, place = frame(frames, first)
    end = vec_mat(sub(end_pose(frames, tool, last)[1], place), rotation)
    aim = vec_mat(sub(goal, place), rotation)
    angle = math.atan2(aim[1], aim[0]) - math.atan2(end[1], end[0])
    cosine, sine = math.cos(angle), math.sin(angle)
    for k in range(first, q.shape[0]):
        x, y = q[k, 0], q[k, 1]
        if bends_in_plane(limits, k):
            continue
        q[k, 0], q[k, 1] = cosine * x - sine * y, sine * x + cosine * y


def turn_to_targets(limits: Array, targets: Array, frames: Array, tool: Array, q: Array) -> None:
    """Turn the shape towards the positions that are asked for, one after the other from the base on.

    What lies beyond a position that is asked for turns about the tangent there, so that all stay on their sides.
    """
    first, n = rigid_rows(limits), q.shape[0]
    for k in range(first, n):
        for i in range(targets.shape[0]):
            if first <= k and targets[i, HAS_POSITION] != 0.0 and end_segment(targets, i, n) == k:
                _turn_segments(limits, frames, tool, first, k, get_vec(targets, i, TARGET_POSITION), q)
                first = k + 1
