"""Where the body may meet obstacles or itself during a tick, as bounds of its motion.

Of every piece of a segment and every obstacle near it the closest place is found: where the gradient of the distance is
across the tangent, or an end of the piece. Its motion along the gradient must not use up the gap.
"""

import math
from collections import namedtuple

from sinuous.kernels.body.contacts import Body
from sinuous.kernels.body.pieces import free_part, look_here, near
from sinuous.kernels.body.self_contacts import MOST_PAIRS, VALUE, WEIGHTS, pull_along, pull_at, self_contacts
from sinuous.kernels.body.self_pairs import Shape
from sinuous.kernels.chain.arc import pose
from sinuous.kernels.chain.kinematics import body_point, frame
from sinuous.kernels.clock import spend
from sinuous.kernels.fields.distances import price_of, slope
from sinuous.kernels.fields.solids import BOUND, EXACT
from sinuous.kernels.maths.vectors import ZERO, Vec, add, cross, dot, get_vec, mat_vec, put_vec, sub
from sinuous.kernels.problem import Problem
from sinuous.kernels.tables import RADIUS
from sinuous.kernels.velocity import layout as v
from sinuous.kernels.velocity.bounds import normalise
from sinuous.kernels.velocity.layout import Tick

PIECES = 4
"""Pieces of a segment."""

CLOSELY = 8
"""Most looks for the closest place of a piece."""

STRAIGHT = 1e-3
"""Cosine between gradient and tangent at which a place is the closest."""

Look = namedtuple("Look", ["keep", "wish", "ahead"])
"""The gap that is kept, the one that is wished for, and up to which gap contacts matter."""


def _finish(tick: Tick, at: int, low: float, wish: float, gap: float, kind: int, segment: int, other: int) -> bool:
    """Finish the bound in row `at`, whose weights are there; say whether anything can move it.

    `low`: what its motion must be at least, `wish`: what it is wished to be; then the gap (length), the kind, the
    segment, and the obstacle or other segment.
    """
    row, own, size = tick.bounds[at], 3 * tick.q.shape[0], normalise(tick, at)
    if size == 0.0:
        return False
    row[own + v.LOW], row[own + v.HIGH] = low / size, math.inf
    row[own + v.WISHED_LOW], row[own + v.WISHED_HIGH] = wish / size, math.inf
    row[own + v.KIND_LOW] = row[own + v.KIND_HIGH] = kind
    row[own + v.GAP], row[own + v.SEGMENT], row[own + v.OTHER] = gap, segment, other
    return True


def _steepness(problem: Problem, tick: Tick | Body, i: int, k: int, s: float) -> tuple[float, float, Vec, Vec]:
    """Distance of a place to obstacle `i`, how it changes along the backbone, its gradient, and the place."""
    rotation, position = frame(tick.frames, k)
    turn, shift = pose(s * tick.q[k, 0], s * tick.q[k, 1], s * tick.q[k, 2])
    p = add(position, mat_vec(rotation, shift))
    tangent = mat_vec(rotation, (turn[0][2], turn[1][2], turn[2][2]))
    d, g = slope(problem.scene, i, p, math.inf, EXACT)
    return d, dot(g, tangent), g, p


def closest_place(
    problem: Problem, tick: Tick | Body, i: int, part: tuple[int, float, float], straight: float, most: int
) -> tuple[float, float, Vec, Vec]:
    """Fraction of a segment where it is closest to obstacle `i`; distance, gradient, place.

    `part`: the segment, and the fractions of it between which that is looked for. It is found to the cosine `straight`
    between gradient and tangent, in `most` looks at most.
    """
    k, a, b = part
    d, fa, g, p = _steepness(problem, tick, i, k, a)
    if fa >= 0.0:
        return a, d, g, p
    d, fb, g, p = _steepness(problem, tick, i, k, b)
    if fb <= 0.0:
        return b, d, g, p
    s = b
    for _ in range(most):
        s = min(max((a * fb - b * fa) / (fb - fa), a), b)
        d, f, g, p = _steepness(problem, tick, i, k, s)
        if abs(f) < straight:
            break
        if f > 0.0:
            b, fb, fa = s, f, 0.5 * fa  # the Illinois rule: an end that stays counts half
        else:
            a, fa, fb = s, f, 0.5 * fb
    return s, d, g, p


def _place_for(tick: Tick, first: int, count: int, most: int, gap: float) -> int:
    """The next free bound, else that of the contact with the largest gap; -1 where none is larger."""
    if count < most:
        return count
    own, widest = 3 * tick.q.shape[0] + v.GAP, first
    for at in range(first + 1, count):
        if tick.bounds[at, own] > tick.bounds[widest, own]:
            widest = at
    return widest if tick.bounds[widest, own] > gap else -1


def _put_contact(problem: Problem, tick: Tick, at: int, k: int, s: float, p: Vec, force: Vec) -> None:
    """Write into row `at` how the place `p`, at fraction `s` of segment `k`, moves along the unit vector `force`."""
    origin = frame(tick.frames, 0)[1]
    torque = cross(sub(p, origin), force)
    shape = Shape(problem.limits, tick.q, tick.frames, tick.spans)
    for j in range(tick.q.shape[0]):
        weights = pull_along(tick.columns, j, torque, force) if j < k else ZERO
        if j == k:
            weights = pull_at(shape, origin, k, s, torque, force)
        put_vec(tick.bounds, at, 3 * j, weights)


def add_contacts(problem: Problem, tick: Tick, look: Look, first: int, most: int) -> tuple[int, float]:
    """Write a bound for every contact, from row `first` on, none beyond row `most`; of too many the nearest.

    Returns the next free row, and the least gap that was seen (infinite: none is below `look.ahead`).
    """
    count, least, mount = first, math.inf, problem.mount
    for k in range(tick.q.shape[0]):
        start, length, radius = free_part(tick.q, k, mount), tick.q[k, 2], problem.limits[k, RADIUS]
        mount -= length
        part = 1.0 - start
        if part <= 0.0 or spend(tick.sweep.clock, problem.scene.table.shape[0]):
            continue
        middle = body_point(tick.q, tick.frames, k, start + 0.5 * part)
        those, _ = near(problem.scene, middle, 0.5 * length * part + radius + look.ahead, tick.near)
        for piece in range(PIECES if those > 0 else 0):
            a, b = start + part * piece / PIECES, start + part * (piece + 1) / PIECES
            reach = 0.5 * length * (b - a) + radius + look.ahead
            middle = body_point(tick.q, tick.frames, k, 0.5 * (a + b))
            for e in range(those):
                i = tick.near[e]
                if look_here(problem.scene, i, middle, reach, BOUND)[0] >= reach:
                    continue
                spend(tick.sweep.clock, 4 * price_of(problem.scene, i))
                s, d, g, p = closest_place(problem, tick, i, (k, a, b), STRAIGHT, CLOSELY)
                gap = d - radius
                least = min(least, gap)
                at = _place_for(tick, first, count, most, gap) if gap < look.ahead else -1
                if at >= 0:
                    _put_contact(problem, tick, at, k, s, p, g)
                    if _finish(tick, at, min(0.0, look.keep - gap), look.wish - gap, gap, v.CLEARANCE, k, i):
                        count = max(count, at + 1)
    return count, least


def add_self_contacts(problem: Problem, tick: Tick, look: Look, first: int) -> tuple[int, float]:
    """The same for the body and itself; `look.wish` is of obstacles alone."""
    if not problem.avoids_itself:
        return first, math.inf
    shape = Shape(problem.limits, tick.q, tick.frames, tick.spans)
    found, least = self_contacts(shape, tick.columns, look.ahead, problem.unit, tick.pairs)
    at = first
    for a in range(min(found, MOST_PAIRS)):
        gap = look.ahead - tick.pairs[a, VALUE] * problem.unit
        low = high = -1
        for k in range(tick.q.shape[0]):
            weights = get_vec(tick.pairs, a, WEIGHTS + 3 * k)
            put_vec(tick.bounds, at, 3 * k, weights)
            if dot(weights, weights) > 0.0:
                low, high = k if low < 0 else low, k
        value = (look.keep - gap) / problem.unit
        if _finish(tick, at, min(0.0, value), value, gap, v.SELF_CLEARANCE, low, high):
            at += 1
    return at, least
