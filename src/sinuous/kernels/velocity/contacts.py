"""Where the body may meet obstacles or itself during a control step, as bounds of its motion.

Of every piece of a segment and every obstacle near it the closest place is found: where the gradient of the distance is
across the tangent, or an end of the piece. Its motion along the gradient must not use up the gap.
"""

import math
from collections import namedtuple

from sinuous.kernels.body.contacts import PosedBody
from sinuous.kernels.body.pieces import backbone_of, evaluate_here, free_part, near
from sinuous.kernels.body.self_contacts import PAIR_VALUE, PAIR_WEIGHTS, put_place_weights, self_contacts
from sinuous.kernels.body.self_pairs import Shape
from sinuous.kernels.chain.arc import pose
from sinuous.kernels.chain.kinematics import body_point, frame
from sinuous.kernels.clock import spend
from sinuous.kernels.fields.distances import slope, work_of
from sinuous.kernels.fields.solids import LOWER_BOUND
from sinuous.kernels.maths.vectors import Vec, add, dot, get_vec, mat_vec, put_vec
from sinuous.kernels.problem import Problem
from sinuous.kernels.tables import RADIUS
from sinuous.kernels.velocity import layout as v
from sinuous.kernels.velocity.bounds import normalise
from sinuous.kernels.velocity.layout import Control

STEP_PIECES = 4
"""Pieces of a segment."""

STEP_EVALUATIONS = 8
"""Most evaluations for the closest place of a piece."""

STEP_COSINE = 1e-3
"""Cosine between gradient and tangent at which a place is the closest."""

ContactGaps = namedtuple("ContactGaps", ["keep", "wish", "ahead"])
"""The gap that is kept, the one that is wished for, and up to which gap contacts matter."""


def _finish(
    control: Control, at: int, low: float, wish: float, gap: float, kind: int, segment: int, other: int
) -> bool:
    """Finish the bound in row `at`, whose weights are there; say whether anything can move it.

    `low`: what its motion must be at least, `wish`: what it is wished to be; then the gap (length), the kind, the
    segment, and the obstacle or other segment.
    """
    row, own, size = control.bounds[at], 3 * control.q.shape[0], normalise(control, at)
    if size == 0.0:
        return False
    row[own + v.LOW], row[own + v.HIGH] = low / size, math.inf
    row[own + v.WISHED_LOW], row[own + v.WISHED_HIGH] = wish / size, math.inf
    row[own + v.KIND_LOW] = row[own + v.KIND_HIGH] = kind
    row[own + v.GAP], row[own + v.BOUND_SEGMENT], row[own + v.BOUND_OTHER] = gap, segment, other
    return True


def _steepness(
    problem: Problem, control: Control | PosedBody, i: int, k: int, s: float
) -> tuple[float, float, Vec, Vec]:
    """Distance of a place to obstacle `i`, how it changes along the backbone, its gradient, and the place."""
    rotation, position = frame(control.frames, k)
    turn, shift = pose(s * control.q[k, 0], s * control.q[k, 1], s * control.q[k, 2])
    p = add(position, mat_vec(rotation, shift))
    tangent = mat_vec(rotation, (turn[0][2], turn[1][2], turn[2][2]))
    d, g = slope(problem.scene, i, p)
    return d, dot(g, tangent), g, p


def closest_place(
    problem: Problem, control: Control | PosedBody, i: int, part: tuple[int, float, float], straight: float, most: int
) -> tuple[float, float, Vec, Vec]:
    """Fraction of a segment where it is closest to obstacle `i`; distance, gradient, place.

    `part`: the segment, and the fractions of it between which it is sought. It is found to the cosine `straight` of
    gradient and tangent, in `most` evaluations at most.
    """
    k, a, b = part
    d, fa, g, p = _steepness(problem, control, i, k, a)
    if fa >= 0.0:
        return a, d, g, p
    d, fb, g, p = _steepness(problem, control, i, k, b)
    if fb <= 0.0:
        return b, d, g, p
    s = b
    for _ in range(most):
        s = min(max((a * fb - b * fa) / (fb - fa), a), b)
        d, f, g, p = _steepness(problem, control, i, k, s)
        if abs(f) < straight:
            break
        if f > 0.0:
            b, fb, fa = s, f, 0.5 * fa  # the Illinois rule: an end that stays counts half
        else:
            a, fa, fb = s, f, 0.5 * fb
    return s, d, g, p


def _place_for(control: Control, first: int, count: int, most: int, gap: float) -> int:
    """The next free bound, else that of the contact with the largest gap; -1 where none is larger."""
    if count < most:
        return count
    own, widest = 3 * control.q.shape[0] + v.GAP, first
    for at in range(first + 1, count):
        if control.bounds[at, own] > control.bounds[widest, own]:
            widest = at
    return widest if control.bounds[widest, own] > gap else -1


def add_contacts(problem: Problem, control: Control, gaps: ContactGaps, first: int, most: int) -> tuple[int, float]:
    """Write a bound for every contact, from row `first` on, none beyond row `most`; of too many the nearest.

    Returns the next free row, and the least gap that was seen (infinite: none is below `gaps.ahead`).
    """
    count, least, mount = first, math.inf, problem.mount
    shape = Shape(problem.limits, control.q, control.frames, control.spans)
    for k in range(control.q.shape[0]):
        start, length, radius = (
            free_part(problem.limits, control.q, k, mount),
            control.q[k, 2],
            problem.limits[k, RADIUS],
        )
        mount -= backbone_of(problem.limits, control.q, k)
        part = 1.0 - start
        if part <= 0.0 or spend(control.sweep.clock, problem.scene.table.shape[0]):
            continue
        middle = body_point(control.q, control.frames, k, start + 0.5 * part)
        those, _ = near(problem.scene, middle, 0.5 * length * part + radius + gaps.ahead, control.near)
        for piece in range(STEP_PIECES if those > 0 else 0):
            a, b = start + part * piece / STEP_PIECES, start + part * (piece + 1) / STEP_PIECES
            reach = 0.5 * length * (b - a) + radius + gaps.ahead
            middle = body_point(control.q, control.frames, k, 0.5 * (a + b))
            for e in range(those):
                i = control.near[e]
                if evaluate_here(problem.scene, i, middle, reach, LOWER_BOUND)[0] >= reach:
                    continue
                spend(control.sweep.clock, 4 * work_of(problem.scene, i))
                s, d, g, p = closest_place(problem, control, i, (k, a, b), STEP_COSINE, STEP_EVALUATIONS)
                gap = d - radius
                least = min(least, gap)
                at = _place_for(control, first, count, most, gap) if gap < gaps.ahead else -1
                if at >= 0:
                    put_place_weights(shape, control.columns, (k, s, p), g, control.bounds, at)
                    if _finish(control, at, min(0.0, gaps.keep - gap), gaps.wish - gap, gap, v.CLEARANCE_LIMIT, k, i):
                        count = max(count, at + 1)
    return count, least


def add_self_contacts(problem: Problem, control: Control, gaps: ContactGaps) -> tuple[int, float]:
    """The same for the body and itself, from row 0 on; `gaps.wish` is of obstacles alone."""
    if not problem.avoids_itself:
        return 0, math.inf
    shape = Shape(problem.limits, control.q, control.frames, control.spans)
    found, least = self_contacts(shape, control.columns, gaps.ahead, problem.unit, control.pairs)
    at = 0
    for a in range(found):
        gap = gaps.ahead - control.pairs[a, PAIR_VALUE] * problem.unit
        low = high = -1
        for k in range(control.q.shape[0]):
            weights = get_vec(control.pairs, a, PAIR_WEIGHTS + 3 * k)
            put_vec(control.bounds, at, 3 * k, weights)
            if dot(weights, weights) > 0.0:
                low, high = k if low < 0 else low, k
        value = (gaps.keep - gap) / problem.unit
        if _finish(control, at, min(0.0, value), value, gap, v.SELF_CLEARANCE_LIMIT, low, high):
            at += 1
    return at, least
