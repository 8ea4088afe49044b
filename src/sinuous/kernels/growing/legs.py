"""The legs of a route: from the base to the first target that has a position, from there to the next, to the last."""

import math
from collections import namedtuple

from sinuous.kernels.chain.kinematics import compose, frame
from sinuous.kernels.freespace.band import line_length
from sinuous.kernels.growing.arcs import Start, thickness
from sinuous.kernels.growing.guide import Guide
from sinuous.kernels.maths.vectors import ZERO, Array, dot, get_vec, norm, sub
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.targets import backbone_end, end_segment, tangent_back
from sinuous.kernels.tables import HAS_POSITION, MAX_BEND, MAX_LENGTH, MIN_LENGTH, TARGET_POSITION

LARGEST_TURN_RADIUS = 0.25
"""Largest radius of a turn that counts, in lengths of the robot."""

TURN_COST = 0.5
"""What a radian counts that the end is turned away, in lengths of a segment."""

Leg = namedtuple("Leg", ["guide", "target", "first", "last", "around"])
"""The guide along one leg; the target that it leads to; its first segment, and the last, whose end has to be there; and
how far from the end of the guide the backbone ends, because of a tool."""


def _find_target(problem: Problem, number: int) -> tuple[int, int]:
    """The target that leg `number` leads to, and the segment that it concerns; targets are in the order of those."""
    n = problem.limits.shape[0]
    found, last = -1, -1
    for _ in range(number + 1):
        before, last = last, n
        for i in range(problem.targets.shape[0]):
            k = end_segment(problem.targets, i, n)
            if problem.targets[i, HAS_POSITION] != 0.0 and before < k < last:
                found, last = i, k
    return found, min(last, n - 1)


def make_leg(problem: Problem, points: Array, number: int, first: int) -> Leg:
    """Leg `number`, from segment `first` on, along points (K, 3), which are evenly spaced, or nearly so."""
    limits, count = problem.limits, points.shape[0]
    radius, turn = math.inf, LARGEST_TURN_RADIUS * problem.unit
    for k in range(limits.shape[0]):
        radius = min(radius, thickness(problem, k))
        own = limits[k, MIN_LENGTH] if limits[k, MIN_LENGTH] > 0.0 else limits[k, MAX_LENGTH]
        if limits[k, MAX_BEND] > 0.0:
            turn = min(turn, own / limits[k, MAX_BEND])
    target, last = _find_target(problem, number)
    _, around = backbone_end(problem, target, last)
    back = tangent_back(problem.targets, target) if around == 0.0 else ZERO
    return Leg(Guide(points, line_length(points, count) / (count - 1), back, radius, turn), target, first, last, around)


def distance_to_target(problem: Problem, leg: Leg, end: Start) -> float:
    """How far a chain that ends with this pose is from the target of the leg, as a length."""
    n = problem.limits.shape[0]
    if leg.last == n - 1:
        offset, shift = frame(problem.tool, 0)
        end = compose(end[0], end[1], offset, shift)
    off = norm(sub(get_vec(problem.targets, leg.target, TARGET_POSITION), end[1]))
    back = tangent_back(problem.targets, leg.target)
    if norm(back) > 0.0:
        ahead = (end[0][0][2], end[0][1][2], end[0][2][2])
        off += TURN_COST * problem.unit / n * math.acos(min(1.0, max(-1.0, -dot(ahead, back))))
    return off
