"""The arcs that are tried as the next segment of a chain: aimed at places of the guide, straight, and on rays."""

import math

from sinuous.kernels.chain.arc import pose
from sinuous.kernels.chain.kinematics import compose
from sinuous.kernels.growing.guide import Guide
from sinuous.kernels.maths.vectors import Array, Mat, Vec, get_vec, mat_mat, mat_vec, norm, sub, transpose, vec_mat
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import bend_cap, bends_in_plane, plane_bend, plane_range, project_segment
from sinuous.kernels.tables import BEND_SCALE, MAX_LENGTH, MIN_LENGTH, RADIUS

Start = tuple[Mat, Vec]
"""Rotation and position of the end of a chain."""

ARC_RINGS, ARC_RAYS = 3, 8
"""How many bends are tried, and to how many sides each."""

SPARED = 0.85
"""The largest bend that is tried, as a share of the limit: a chain at its limit cannot be moved any more."""

AIMS = 3
"""Places of the guide that arcs are aimed at."""

SHARES = 3
"""Lengths of an aimed arc, and of the straight one: the needed length, nearly the least, and nearly the greatest."""

LENGTH_INSET = 0.05
"""How far these lengths stay from the limits, as a share of what lies between: at a limit nothing can give way."""

STRAIGHT_LENGTHS = 8
"""Lengths of a segment that cannot bend, or is locked."""

GOLDEN = 0.618034
"""Share of the range by which lengths of arcs on rays differ: neighbours have lengths far apart."""

ARCS = SHARES * (AIMS + 1) + ARC_RINGS * ARC_RAYS
"""Most arcs that are tried beyond one chain."""

ASSUMED_RADIUS = 1e-3
"""Radius of a body that has none, in lengths of the robot."""


def thickness(problem: Problem, k: int) -> float:
    """Radius of segment `k`, or what counts as one where the body has none."""
    return max(problem.limits[k, RADIUS], ASSUMED_RADIUS * problem.unit)


def end_of(start: Start, q: Vec) -> Start:
    """Pose of the end of an arc that begins with a pose."""
    turn, shift = pose(q[0], q[1], q[2])
    return compose(start[0], start[1], turn, shift)


def start_of(end: Start, q: Vec) -> Start:
    """Pose with which an arc begins that ends with a pose."""
    turn, shift = pose(q[0], q[1], q[2])
    rotation = mat_mat(end[0], transpose(turn))
    return rotation, sub(end[1], mat_vec(rotation, shift))


def bend_towards(start: Start, target: Vec, length: float) -> tuple[float, float]:
    """Bend of the arc of this length on the circle that leads to a target."""
    p = vec_mat(sub(target, start[1]), start[0])
    aside = math.hypot(p[0], p[1])
    square = aside * aside + p[2] * p[2]
    if square == 0.0 or aside == 0.0:
        return 0.0, 0.0
    bend = 2.0 * aside / square * length
    return bend * p[0] / aside, bend * p[1] / aside


def ahead_of(guide: Guide, start: Start, seen: int, segments: float, length: float) -> int:
    """Point of the guide that is so many segments of a length ahead of a place that sees point `seen`."""
    beside = seen - max(1, int(norm(sub(get_vec(guide.points, seen, 0), start[1])) / guide.spacing))
    return min(guide.points.shape[0] - 1, max(0, beside) + int(segments * length / guide.spacing))


def _aimed_place(guide: Guide, start: Start, number: int, seen: int, length: float) -> Vec:
    """Place of the guide that arcs are aimed at: the point `seen`, or what is one or one and a half segments ahead."""
    return get_vec(guide.points, seen if number == 0 else ahead_of(guide, start, seen, 0.5 * (1.0 + number), length), 0)


def _count_lengths(problem: Problem, k: int) -> int:
    """How many lengths of segment `k` are tried for each place that it is aimed at."""
    return SHARES if problem.limits[k, MAX_LENGTH] > problem.limits[k, MIN_LENGTH] else 1


def count_arcs(problem: Problem, k: int) -> int:
    """How many arcs of segment `k` are tried beyond a chain."""
    lengths = _count_lengths(problem, k)
    if problem.limits[k, BEND_SCALE] > 0.0:
        return lengths * (AIMS + 1) + ARC_RINGS * ARC_RAYS
    return STRAIGHT_LENGTHS if lengths > 1 else 1


def _straightest_arc(limits: Array, k: int, length: float) -> Vec:
    """The arc of segment `k` with this length that bends the least."""
    if bends_in_plane(limits, k):
        return project_segment(limits, k, 0.0, 0.0, length)
    return 0.0, 0.0, length


def make_arc(problem: Problem, guide: Guide, start: Start, which: tuple[int, int], seen: int, fraction: float) -> Vec:
    """Arc number `which[1]` of segment `which[0]` beyond `start`: its bends (rad) and its length.

    `seen` is the point of the guide that is seen from there; `fraction` says which length is needed, between the least
    and the greatest.
    """
    limits, (k, number) = problem.limits, which
    low, high = limits[k, MIN_LENGTH], limits[k, MAX_LENGTH]
    if limits[k, BEND_SCALE] == 0.0:
        return _straightest_arc(limits, k, low + (high - low) * number / (STRAIGHT_LENGTHS - 1.0))
    lengths = _count_lengths(problem, k)
    if number < lengths * (AIMS + 1):
        aim, variant = number // lengths, number % lengths
        if variant > 0:
            fraction = LENGTH_INSET if variant == 1 else 1.0 - LENGTH_INSET
        length = low + fraction * (high - low)
        if aim == AIMS:
            return _straightest_arc(limits, k, length)
        x, y = bend_towards(start, _aimed_place(guide, start, aim, seen, length), length)
        return project_segment(limits, k, x, y, length)
    number -= lengths * (AIMS + 1)
    ring, ray = number // ARC_RAYS, number % ARC_RAYS
    length = low + (GOLDEN * number % 1.0) * (high - low)
    if bends_in_plane(limits, k):
        low, high = plane_range(limits, k, length)
        z = 0.5 * (low + high) + SPARED * (high - low) * ((number + 0.5) / (ARC_RINGS * ARC_RAYS) - 0.5)
        x, y = plane_bend(limits, k, z)
        return x, y, length
    bend = SPARED * bend_cap(limits, k, length) * (ring + 1.0) / ARC_RINGS
    angle = 2.0 * math.pi * (ray + 0.5 * (ring % 2) + 0.25 * (k % 2)) / ARC_RAYS
    return bend * math.cos(angle), bend * math.sin(angle), length
