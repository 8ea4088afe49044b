"""Two segments during an interval of time: a lower bound of how near they come to each other.

Both are looked at from a joint between them. Seen from there only what turns in between moves them, so within an
interval of duration h a place stays within `h^2 A / 8` of the chord of its path, with an `A` that begins at that joint,
see `sweep`. So all differences of places of two pieces, at all times of the interval, are within both sags and both of
these bounds of the hull of eight: of the ends of the pieces at the ends of the interval. A direction in which all eight
are far enough from 0 proves the pieces apart.
"""

import math
from collections import namedtuple

from sinuous.kernels.between.obstacles import Aim, wanted
from sinuous.kernels.between.sweep import (
    BEND_RATE,
    FRACTION,
    LEAST,
    LENGTH_RATE,
    LOW,
    SEGMENT,
    TURNING,
    WHEN,
    WHICH,
    bow_from,
    place_on,
)
from sinuous.kernels.body.chords import arc_chord, chord_distance, sag
from sinuous.kernels.body.pieces import following
from sinuous.kernels.body.proof import CLEAR, TOUCHING, UNDECIDED
from sinuous.kernels.body.self_pairs import ALONG, CURVATURE, TURNED, Shape, concern
from sinuous.kernels.body.self_pieces import MOST_LOOKS, Pair, Pieces, amount_between, gap_at, pieces_of
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array, Vec, add, add_scaled, dot, norm, scale, sub, vec_mat
from sinuous.kernels.tables import RADIUS

TINY = 1e-300

Course = namedtuple("Course", ["first", "last", "rates", "begin", "h"])
"""The body during an interval: its shapes (`Shape`) when that begins and ends, `rates` (n, 5) of the whole motion, and
when it begins and how long it is, in times of the whole motion."""

Couple = namedtuple("Couple", ["pair", "joint", "back", "ahead"])
"""Two segments as a `Pair`, which holds for the whole interval; the joint between them from which they are looked at;
the rate of turning W and the acceleration A where each of them begins, seen from there."""


@kernel
def _joint(rates: Array, i: int, j: int) -> int:
    """The joint between segments i < j, with about as much turning before it as after: the segment that it begins."""
    half = 0.5 * (rates[i, TURNING] + rates[j, TURNING] + rates[j, BEND_RATE])
    joint = i + 1
    while joint < j and rates[joint, TURNING] + 0.5 * rates[joint, BEND_RATE] < half:
        joint += 1
    return joint


@kernel
def _longest(course: Course, k: int) -> float:
    """Largest length of segment `k` in the interval."""
    return max(course.first.q[k, 2], course.last.q[k, 2])


@kernel
def _past(course: Course, begin: int, end: int, step: int) -> tuple[float, float]:
    """W and A past the segments from `begin` on, up to `end` without that one."""
    rates = course.rates
    turning = bowing = 0.0
    for k in range(begin, end, step):
        bowing += bow_from(turning, rates[k, BEND_RATE], rates[k, LENGTH_RATE], _longest(course, k), 1.0)
        turning += rates[k, BEND_RATE]
    return turning, bowing


@kernel
def couple_of(course: Course, i: int, j: int) -> Couple:
    """Put together what is known of segments i < j in an interval."""
    first, last = course.first, course.last
    column, enough = concern(first, i, j)
    tightest = 0.0
    for k in range(i, j + 1):
        tightest = max(tightest, first.spans[k, CURVATURE], last.spans[k, CURVATURE])
    pair = Pair(i, j, first.limits[i, RADIUS] + first.limits[j, RADIUS], column, enough, tightest)
    joint = _joint(course.rates, i, j)
    return Couple(pair, joint, _past(course, joint - 1, i, -1), _past(course, joint, j, 1))


@kernel
def most_between(course: Course, pair: Pair, column: int, s: float, t: float) -> float:
    """Most that lies of a column of the spans between two places: turns are convex in time, lengths linear."""
    return max(amount_between(course.first, pair, column, s, t), amount_between(course.last, pair, column, s, t))


@kernel
def _by_circle(course: Course, pair: Pair, pieces: Pieces) -> float:
    """Lower bound of the gap of two pieces from the curvature between them; see `self_pieces`."""
    a, u, b, v = pieces
    far = most_between(course, pair, ALONG, a, b + v)
    if pair.tightest * far >= 2.0 * math.pi:
        return -math.inf
    apart = arc_chord(pair.tightest, far)
    if pair.column == ALONG:
        near = min(
            amount_between(course.first, pair, ALONG, a + u, b), amount_between(course.last, pair, ALONG, a + u, b)
        )
        apart = min(apart, arc_chord(pair.tightest, max(pair.enough, near)))
    return apart - pair.needed


@kernel
def _corner(shape: Shape, k: int, s: float, joint: int) -> Vec:
    """A place of the body as it is seen from a joint."""
    rotation, position = frame(shape.frames, joint)
    return vec_mat(sub(place_on(shape.q, shape.frames, k, s), position), rotation)


@kernel
def _lag(course: Course, couple: Couple, pieces: Pieces) -> float:
    """How far differences of places of two pieces may be from the chords of their paths."""
    pair, rates = couple.pair, course.rates
    i, j, a, t = pair.i, pair.j, pieces[0], pieces[2] + pieces[3]
    back = bow_from(couple.back[0], rates[i, BEND_RATE], rates[i, LENGTH_RATE], _longest(course, i), 1.0 - a)
    ahead = bow_from(couple.ahead[0], rates[j, BEND_RATE], rates[j, LENGTH_RATE], _longest(course, j), t)
    return 0.125 * course.h * course.h * (couple.back[1] + back + couple.ahead[1] + ahead)


@kernel
def _sags(course: Course, pair: Pair, pieces: Pieces) -> float:
    """How far both pieces may be from their chords; infinite where one bends by more than half a turn."""
    _, u, _, v = pieces
    first, last, i, j = course.first.spans, course.last.spans, pair.i, pair.j
    ui = u * max(first[i + 1, TURNED] - first[i, TURNED], last[i + 1, TURNED] - last[i, TURNED])
    uj = v * max(first[j + 1, TURNED] - first[j, TURNED], last[j + 1, TURNED] - last[j, TURNED])
    if max(ui, uj) > math.pi:
        return math.inf
    return sag(u * _longest(course, i), ui) + sag(v * _longest(course, j), uj)


@kernel
def _by_corners(course: Course, couple: Couple, pieces: Pieces) -> tuple[float, float, float, float, float]:
    """Lower bound of the gap of two pieces; what place and time leave open of it; where they seem to be closest."""
    a, u, b, v = pieces
    pair, joint = couple.pair, couple.joint
    i, j = pair.i, pair.j
    sags = _sags(course, pair, pieces)
    if sags == math.inf:
        return -math.inf, math.inf, 0.0, a + 0.5 * u, b + 0.5 * v
    p0, p1 = _corner(course.first, i, a, joint), _corner(course.first, i, a + u, joint)
    p2, p3 = _corner(course.last, i, a, joint), _corner(course.last, i, a + u, joint)
    r0, r1 = _corner(course.first, j, b, joint), _corner(course.first, j, b + v, joint)
    r2, r3 = _corner(course.last, j, b, joint), _corner(course.last, j, b + v, joint)
    p, pp = scale(0.5, add(p0, p2)), scale(0.5, add(p1, p3))
    r, rr = scale(0.5, add(r0, r2)), scale(0.5, add(r1, r3))
    _, s, t = chord_distance(p, pp, r, rr)
    across = sub(add_scaled(r, t, sub(rr, r)), add_scaled(p, s, sub(pp, p)))
    g = scale(1.0 / (norm(across) + TINY), across)
    x0, x1, x2, x3 = dot(g, p0), dot(g, p1), dot(g, p2), dot(g, p3)
    y0, y1, y2, y3 = dot(g, r0), dot(g, r1), dot(g, r2), dot(g, r3)
    low = min(min(y0, y1) - max(x0, x1), min(y2, y3) - max(x2, x3))
    lag = _lag(course, couple, pieces)
    space = sags + 0.5 * max(abs(x1 - x0) + abs(y1 - y0), abs(x3 - x2) + abs(y3 - y2))
    moved = max(max(y2 - y0, y3 - y1) - min(x2 - x0, x3 - x1), max(x2 - x0, x3 - x1) - min(y2 - y0, y3 - y1))
    return low - sags - lag - pair.needed, space, lag + 0.5 * moved, a + s * u, b + t * v


@kernel
def _see(course: Course, pair: Pair, pieces: Pieces, places: tuple[float, float], seen: Array) -> bool:
    """Keep the gap between two places at the ends of the interval, if it is less than what was `seen` (6,).

    Where these do not concern each other, the places of their pieces that are farthest apart along the body are taken.
    Returns whether there is an overlap.
    """
    least = math.inf
    for at_end in range(2):
        shape = course.last if at_end else course.first
        s, t = places
        if amount_between(shape, pair, pair.column, s, t) < pair.enough:
            s, t = pieces[0], pieces[2] + pieces[3]
        if amount_between(shape, pair, pair.column, s, t) < pair.enough:
            continue
        gap, when = gap_at(shape, pair, s, t), course.begin + at_end * course.h
        least = min(least, gap)
        if gap < seen[LEAST]:
            seen[LEAST], seen[WHEN], seen[SEGMENT], seen[FRACTION], seen[WHICH] = gap, when, pair.i, s, pair.j
    return least < 0.0


@kernel
def clear_couple(course: Course, couple: Couple, aim: Aim, seen: Array) -> tuple[int, int]:
    """Prove two segments apart during an interval: both are halved where that helps more than halving the time.

    Returns the verdict, and how many pairs of pieces were looked at. Keeps in `seen` (6,) what was found. TOUCHING ends
    the work: nothing proves the interval.
    """
    pair = couple.pair
    level = piece = looks = 0
    while piece < 1 << level:
        pieces = pieces_of(level, piece)
        a, u, b, v = pieces
        if most_between(course, pair, pair.column, a, b + v) >= pair.enough:
            looks += 1
            low = _by_circle(course, pair, pieces) - aim.rounding
            if not (low > 0.0 and low >= wanted(aim, seen)):
                by_corners, space, time, s, t = _by_corners(course, couple, pieces)
                low = max(low, by_corners - aim.rounding)
                if not (low > 0.0 and low >= wanted(aim, seen)):
                    if _see(course, pair, pieces, (s, t), seen):
                        return TOUCHING, looks
                    size = u * _longest(course, pair.i) + v * _longest(course, pair.j)
                    if space <= time or size <= aim.finest or looks >= MOST_LOOKS:
                        return UNDECIDED, looks
                    level, piece = level + 1, 2 * piece
                    continue
            seen[LOW] = min(seen[LOW], low)
        level, piece = following(level, piece)
    return CLEAR, looks


@kernel
def apart(course: Course, i: int, j: int) -> float:
    """Lower bound of the distance of segments i < j during an interval, from balls about them at both ends of it.

    A bend moves what is half the length between away from what is the other half, at most.
    """
    first, last, rates = course.first, course.last, course.rates
    stretching = 0.0
    for k in range(i, j + 1):
        stretching += rates[k, LENGTH_RATE]
    bending = rates[j, TURNING] + rates[j, BEND_RATE] - rates[i, TURNING]
    length = max(first.spans[j + 1, ALONG] - first.spans[i, ALONG], last.spans[j + 1, ALONG] - last.spans[i, ALONG])
    lost = 0.5 * course.h * (0.5 * bending * length + stretching)
    return 0.5 * (_balls(first, i, j) + _balls(last, i, j)) - lost


@kernel
def _balls(shape: Shape, i: int, j: int) -> float:
    """Lower bound of the distance between places of segments i and j, from balls about them."""
    first, second = add(frame(shape.frames, i)[1], frame(shape.frames, i + 1)[1]), frame(shape.frames, j)[1]
    middles = 0.5 * norm(sub(first, add(second, frame(shape.frames, j + 1)[1])))
    return middles - 0.5 * float(shape.q[i, 2] + shape.q[j, 2])


@kernel
def never_concern(course: Course, i: int, j: int) -> bool:
    """Whether no two places of segments i < j concern each other during an interval."""
    first, last = course.first, course.last
    column, enough = concern(first, i, j)
    most = max(first.spans[j + 1, column] - first.spans[i, column], last.spans[j + 1, column] - last.spans[i, column])
    return bool(most < enough or first.limits[i, RADIUS] + first.limits[j, RADIUS] == 0.0)
