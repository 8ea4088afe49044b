"""Whether a new segment of a chain comes too near to those before it.

`levels` (n + 1, w, CHAIN_WIDTH) are the chains of `beam`.
"""

import math

from sinuous.kernels.body.chords import nearest_share
from sinuous.kernels.chain.arc import point
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.growing.arcs import Start
from sinuous.kernels.growing.beam import CHAIN_LENGTH, LAST_SEGMENT_Q, PARENT
from sinuous.kernels.maths.vectors import Array, Vec, add, add_scaled, get_vec, mat_vec, norm, sub
from sinuous.kernels.problem import Problem
from sinuous.kernels.tables import SELF_RADIUS

CHORDS_OF_SEGMENT = 3
"""Pieces of a segment, of which ends are compared with chords: a first check, which a proof follows."""

Arc = tuple[Start, Vec, float]
"""Where an arc begins, its bends and length, and the length of the chain up to there."""


def _piece_begin(arc: Arc, piece: int) -> Vec:
    """Where piece number `piece` of an arc begins."""
    (rotation, position), q, _ = arc
    s = piece / CHORDS_OF_SEGMENT
    return add(position, mat_vec(rotation, point(s * q[0], s * q[1], s * q[2])))


def _distance_from_chord(p: Vec, a: Vec, b: Vec) -> float:
    """Distance of a point from a chord."""
    line = sub(b, a)
    return norm(sub(p, add_scaled(a, nearest_share(p, a, line), line)))


def _come_too_near(one: Arc, other: Arc, apart: float, near: float) -> bool:
    """Whether places of `one` that are farther than `apart` along the body from a chord of `other` come too near."""
    for a in range(CHORDS_OF_SEGMENT):
        first, last = _piece_begin(other, a), _piece_begin(other, a + 1)
        gone = other[2] + other[1][2] * (a + 1) / CHORDS_OF_SEGMENT
        for b in range(1, CHORDS_OF_SEGMENT + 1):
            between = one[2] + one[1][2] * b / CHORDS_OF_SEGMENT - gone
            if between > apart and _distance_from_chord(_piece_begin(one, b), first, last) < near:
                return True
    return False


def meets_itself(problem: Problem, levels: Array, k: int, i: int, start: Start, q: Vec) -> bool:
    """Whether segment `k`, with the coordinates `q`, beyond chain `i` comes nearer to that chain than their radii.

    It begins with the pose `start`: near the end of that chain.
    """
    new = start, q, levels[k, i, CHAIN_LENGTH]
    end = _piece_begin(new, CHORDS_OF_SEGMENT)
    own = problem.limits[k, SELF_RADIUS]
    while k > 0:
        parent, radius = int(levels[k, i, PARENT]), problem.limits[k - 1, SELF_RADIUS]
        old = frame(levels[k - 1], parent), get_vec(levels[k], i, LAST_SEGMENT_Q), levels[k - 1, parent, CHAIN_LENGTH]
        near = own + radius
        close = norm(sub(old[0][1], end)) < near + q[2] + old[1][2]
        if close and _come_too_near(new, old, math.pi * max(own, radius), near):
            return True
        i, k = parent, k - 1
    return False
