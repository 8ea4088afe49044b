"""The proof that a segment is clear of obstacles while time goes from one knot to the next.

All places of a piece of the segment, at all times of the interval, are near the middle of four corners: the two ends of
the piece at the two ends of the interval. Distances change by no more than one moves. Where an obstacle is a convex
primitive, its distance is a convex function: no less than its tangent at the middle says, at the corner where that is
least. So is that to each triangle of a mesh and each ball of a cloud. Where the body must stay inside a primitive, the
distance is concave, and so it is least at a corner. What cannot be decided is halved: the piece of the segment, or,
where motion is what leaves it open, the interval of time.

`seen` (6,) is what is known of clearances from obstacles, see `sweep`.
"""

import math
from collections import namedtuple

from sinuous.kernels.body.chords import sagitta_bound
from sinuous.kernels.body.pieces import BEYOND, MANY, backbone_of, evaluate_here, following, free_part, near
from sinuous.kernels.body.proof import CLEAR, LOOSENESS, TOUCHING, UNDECIDED
from sinuous.kernels.certificate.drift import OF, drift_of
from sinuous.kernels.certificate.sweep import LEAST_SEEN, PROVED_BOUND, Motion, Sweep, note_least
from sinuous.kernels.chain.kinematics import body_point, place_on
from sinuous.kernels.chain.rates import TAIL, acceleration_bound
from sinuous.kernels.clock import spend
from sinuous.kernels.fields.distances import Scene, bound_patch, evaluate, is_large, slope, tangents_pay, work_of
from sinuous.kernels.fields.primitives import Patch
from sinuous.kernels.fields.solids import EXACT, LOWER_BOUND
from sinuous.kernels.maths.vectors import Array, Vec, add, dot, get_vec, norm, put_vec, scale, sub
from sinuous.kernels.tables import CENTER, EXTENT, KIND, LINK, MAX_LENGTH, ONWARD, RADIUS, RIGID, ROUNDOFF, SIGN, TREE

Accuracy = namedtuple("Accuracy", ["slack", "finest", "rounding", "mount", "prefix"])
"""How far below the truth a clearance may be, as a share of it, and by `finest` more: with 1 it is enough that it is
greater than 0. Pieces shorter than `finest`, and times in which nothing moves that far, are not halved. `rounding` is
what arithmetic may be wrong by, `mount` the length of backbone that obstacles do not concern. With `prefix` an overlap
does not end the work, only that of its interval: everything before it is to be proved."""

Interval = namedtuple("Interval", ["level", "begin", "h", "a", "b"])
"""Halvings of time, when it begins and how long it is, and which knots of the sweep its ends are."""

Piece = namedtuple("Piece", ["k", "s", "width", "half", "bend", "radius", "lag", "reach", "center", "free"])
"""A piece of segment k: the fraction in its middle and how many fractions long it is; half its length, its largest bend
(rad) and its radius; how far the place in its middle may be from the chord of its path; the middle of that chord, and
how far from there the body may be; whether that place is beyond the mount half-way through the interval."""


PieceCorners = tuple[Vec, Vec, Vec, Vec]


def wanted(accuracy: Accuracy, seen: Array) -> float:
    """The clearance from which on a bound is as good as it has to be, for what was `seen` (6,)."""
    if accuracy.slack >= 1.0 or seen[LEAST_SEEN] == math.inf:
        return 0.0
    return max(0.0, (1.0 - accuracy.slack) * float(seen[LEAST_SEEN]) - accuracy.finest)


def good_enough(low: float, accuracy: Accuracy, seen: Array) -> bool:
    """Whether a lower bound of a clearance is as good as it has to be, for what was `seen` (6,)."""
    return bool(low > 0.0 and low >= wanted(accuracy, seen))


BALL = 3
"""Column of a ball: its radius, after its center."""

GRACE = 1.0 + 1e-9
"""By how much more than its length a segment is taken to reach."""


def keep_reachable(limits: Array, base: Vec, scene: Scene, sweep: Sweep) -> None:
    """Leave out of the lists of obstacles what a segment (rows (n, 35)) cannot reach from the `base`.

    Lower bounds of clearances hold for what can be reached, then. Of a large scene nothing is listed: its hierarchy is
    asked what is near.
    """
    if is_large(scene):
        return
    along = 0.0
    for k in range(limits.shape[0]):
        end = along + limits[k, ONWARD]
        if limits[k, RIGID] != LINK:
            along = end = end + limits[k, MAX_LENGTH]
        within, count = GRACE * (end + limits[k, RADIUS]), 0
        for i in range(scene.table.shape[0]):
            far = within + scene.table[i, ROUNDOFF]
            if evaluate_here(scene, i, base, far, LOWER_BOUND)[0] < far:
                sweep.reach[k, count] = i
                count += 1
        sweep.reached[k] = count


def measure_balls(motion: Motion, sweep: Sweep) -> None:
    """Fill the balls about primitives that stand still: center, and radius with what arithmetic may make of a distance.

    That of anything else, and of what has no end, is infinite.

    Most obstacles are far from a piece of the body. Their balls, side by side in memory, say so in a third of the time.
    In a large scene the hierarchy does.
    """
    table, balls = motion.scene.table, sweep.balls
    for i in range(balls.shape[0]):
        put_vec(balls, i, 0, get_vec(table, i, CENTER))
        balls[i, BALL] = table[i, EXTENT] + table[i, ROUNDOFF] if table[i, KIND] < TREE else math.inf
    for e in range(motion.drifts.shape[0] if balls.shape[0] > 0 else 0):
        balls[int(motion.drifts[e, OF]), BALL] = math.inf


def _begin_of(limits: Array, q: Array, k: int) -> float:
    """Length of the backbone before segment `k`; infinite for a joint or a link, which the mount does not concern."""
    if limits[k, RIGID] != 0.0:
        return math.inf
    along = 0.0
    for j in range(k):
        along += backbone_of(limits, q, j)
    return along


def _piece(
    sweep: Sweep,
    interval: Interval,
    k: int,
    radius: float,
    s: float,
    width: float,
    begins: tuple[float, float],
    mount: float,
) -> Piece:
    """The piece of segment `k` about the fraction `s`; `begins`: where on the backbone that segment begins."""
    qa, qb, fa, fb = sweep.q[interval.a], sweep.q[interval.b], sweep.frames[interval.a], sweep.frames[interval.b]
    length = max(qa[k, 2], qb[k, 2])
    half = 0.5 * length * width
    lag = 0.125 * interval.h * interval.h * acceleration_bound(sweep.rates, k, length, s + 0.5 * width)
    bend = width * math.sqrt(max(qa[k, 0] * qa[k, 0] + qa[k, 1] * qa[k, 1], qb[k, 0] * qb[k, 0] + qb[k, 1] * qb[k, 1]))
    here, there = body_point(qa, fa, k, s), body_point(qb, fb, k, s)
    reach = half + lag + 0.5 * norm(sub(there, here)) + radius
    along = 0.5 * (begins[0] + begins[1] + s * (qa[k, 2] + qb[k, 2]))
    return Piece(k, s, width, half, bend, radius, lag, reach, scale(0.5, add(here, there)), along >= mount)


def _corners_of(sweep: Sweep, interval: Interval, piece: Piece) -> PieceCorners:
    """The ends of a piece when an interval begins, and when it ends."""
    qa, qb, fa, fb = sweep.q[interval.a], sweep.q[interval.b], sweep.frames[interval.a], sweep.frames[interval.b]
    k, r, t = piece.k, piece.s - 0.5 * piece.width, piece.s + 0.5 * piece.width
    tail = sweep.rates[k, TAIL]
    return (
        place_on(qa, fa, tail, k, r),
        place_on(qa, fa, tail, k, t),
        place_on(qb, fb, tail, k, r),
        place_on(qb, fb, tail, k, t),
    )


def _sagitta(piece: Piece) -> float:
    """How far the body is from the chord of a piece, at most; infinite where it is bent by more than half a turn."""
    return sagitta_bound(2.0 * piece.half, piece.bend) if piece.bend <= math.pi else math.inf


def _by_corners(scene: Scene, i: int, corners: PieceCorners, piece: Piece, reach: float) -> tuple[float, float, float]:
    """Lower bound of the distance of a piece to an obstacle, from its corners; what place and time leave open of it.

    What is not less than `reach` need not be exact.
    """
    c0, c1, c2, c3 = corners
    center = scale(0.25, add(add(c0, c1), add(c2, c3)))
    sagitta = _sagitta(piece)
    if scene.table[i, KIND] >= TREE:
        along, onward = sub(add(c1, c3), add(c0, c2)), sub(add(c2, c3), add(c0, c1))
        twist = sub(add(c0, c3), add(c1, c2))
        patch = Patch(center, scale(0.25, along), scale(0.25, onward), scale(0.25, twist))
        low, g = bound_patch(scene, i, patch, sagitta, reach)
        if low == -math.inf:
            return low, piece.half, piece.reach - piece.half - piece.radius
        deviation = abs(dot(g, patch.onward)) + abs(dot(g, patch.twist))
        return low - piece.lag, sagitta + abs(dot(g, patch.along)), piece.lag + deviation
    d, g = slope(scene, i, center)
    z = dot(g, center)
    g0, g1, g2, g3 = dot(g, c0) - z, dot(g, c1) - z, dot(g, c2) - z, dot(g, c3) - z
    low = d + min(g0, g1, g2, g3)
    if scene.table[i, SIGN] < 0.0:
        d0, d1 = slope(scene, i, c0)[0], slope(scene, i, c1)[0]
        d2, d3 = slope(scene, i, c2)[0], slope(scene, i, c3)[0]
        low = min(d0, d1, d2, d3)
    space = sagitta + 0.5 * max(abs(g1 - g0), abs(g3 - g2))
    return low - sagitta - piece.lag, space, piece.lag + 0.5 * max(abs(g2 - g0), abs(g3 - g1))


def _far(sweep: Sweep, i: int, piece: Piece, enough: float) -> bool:
    """Whether obstacle `i` is known to be farther from the center of a piece than what would change anything."""
    if sweep.balls.shape[0] == 0:
        return False
    away, passed = sub(piece.center, get_vec(sweep.balls, i, 0)), sweep.balls[i, BALL] + enough
    return dot(away, away) > passed * passed


def _list_near(motion: Motion, sweep: Sweep, piece: Piece, accuracy: Accuracy, seen: Array) -> int:
    """List all obstacles of a large scene that may be too near to a piece; return their number.

    Those that move are among them, wherever they are: how far they come is not known here.
    """
    reach, listed = piece.reach + accuracy.rounding, sweep.near[piece.k]
    margin = max(wanted(accuracy, seen), accuracy.rounding, min(seen[LEAST_SEEN], piece.reach))
    count, rest = near(motion.scene, piece.center, BEYOND * (reach + margin), listed)
    seen[PROVED_BOUND] = min(seen[PROVED_BOUND], rest - reach)
    for e in range(motion.drifts.shape[0]):
        i, known = int(motion.drifts[e, OF]), False
        for at in range(count):
            known = known or listed[at] == i
        if not known:
            listed[count] = i
            count += 1
    return count


def _narrow(motion: Motion, sweep: Sweep, interval: Interval, piece: Piece, accuracy: Accuracy, seen: Array) -> int:
    """Put those obstacles first that may be too near to a piece during an interval; return their number."""
    scene, own, k = motion.scene, sweep.near, piece.k
    reach, more = piece.reach + accuracy.rounding, max(wanted(accuracy, seen), accuracy.rounding)
    count, listed = 0, sweep.counts[interval.level, k]
    if listed == MANY:
        listed = _list_near(motion, sweep, piece, accuracy, seen)
    for e in range(listed):
        i = own[k, e]
        if _far(sweep, i, piece, reach + max(seen[PROVED_BOUND], more)):
            continue
        far = reach + scene.table[i, ROUNDOFF] + drift_of(sweep, i, interval.h, piece.center, piece.reach)
        enough = far + more  # beyond that, what is returned may be no more than that
        d, _ = evaluate_here(scene, i, piece.center, enough, LOWER_BOUND)
        if d < enough:
            own[k, e], own[k, count] = own[k, count], i
            count += 1
        else:
            seen[PROVED_BOUND] = min(seen[PROVED_BOUND], d - far)
    return count


def _decide(
    scene: Scene, sweep: Sweep, interval: Interval, piece: Piece, count: int, accuracy: Accuracy, seen: Array
) -> tuple[int, float, float, int]:
    """Prove a piece clear of the first `count` obstacles of its segment during an interval.

    Returns the verdict; what place and time leave open, where that is not CLEAR; and how many evaluations it took.
    """
    verdict, space, time, units = CLEAR, 0.0, 0.0, 0
    reach = piece.reach + accuracy.rounding
    known, corners = False, (piece.center, piece.center, piece.center, piece.center)
    for e in range(count):
        i = sweep.near[piece.k, e]
        enough = reach + max(seen[PROVED_BOUND], wanted(accuracy, seen))
        if _far(sweep, i, piece, max(enough, seen[LEAST_SEEN] + piece.radius - piece.lag)):
            continue
        drift = drift_of(sweep, i, interval.h, piece.center, piece.reach) + scene.table[i, ROUNDOFF]
        enough = reach + drift + wanted(accuracy, seen) + accuracy.rounding
        units += work_of(scene, i)
        d, most = evaluate_here(scene, i, piece.center, enough, LOWER_BOUND)
        if d < enough and most - d > LOOSENESS * (piece.reach - piece.radius):
            d, most = evaluate(scene, i, piece.center, enough, EXACT)
        gap = most + piece.lag - piece.radius
        if piece.free and gap < seen[LEAST_SEEN]:
            note_least(seen, gap, interval.begin + 0.5 * interval.h, piece.k, piece.s, i)
            if gap < 0.0:
                return TOUCHING, piece.half, reach, units
        low, place, motion = d - reach - drift, piece.half, reach - piece.half - piece.radius
        deviation = piece.radius + accuracy.rounding + drift
        slack = d - deviation - piece.lag - _sagitta(piece) - wanted(accuracy, seen)
        if not good_enough(low, accuracy, seen) and tangents_pay(scene, i, d, piece.reach - piece.radius, slack):
            if not known:
                known, corners = True, _corners_of(sweep, interval, piece)
            by_corners, place, motion = _by_corners(scene, i, corners, piece, enough)
            low = max(low, by_corners - deviation)
            units += 2 * work_of(scene, i)
        if good_enough(low, accuracy, seen):
            seen[PROVED_BOUND] = min(seen[PROVED_BOUND], low)
            continue
        verdict = UNDECIDED
        space, time = max(space, place), max(time, motion + drift)
    return verdict, space, time, units


def _begin_segment(
    motion: Motion, sweep: Sweep, interval: Interval, k: int, mount: float
) -> tuple[float, tuple[float, float]]:
    """Fraction of segment `k` from which on it is beyond the mount some time in an interval; and its `begins`.

    All of it where it has no obstacles near it: then none is left for the halves of the interval.
    """
    sweep.counts[interval.level + 1, k] = 0
    if sweep.counts[interval.level, k] == 0:
        return 1.0, (0.0, 0.0)
    begins = (_begin_of(motion.limits, sweep.q[interval.a], k), _begin_of(motion.limits, sweep.q[interval.b], k))
    first = free_part(motion.limits, sweep.q[interval.a], k, mount - begins[0])
    return min(first, free_part(motion.limits, sweep.q[interval.b], k, mount - begins[1])), begins


def narrow_segment(motion: Motion, sweep: Sweep, interval: Interval, k: int, accuracy: Accuracy, seen: Array) -> None:
    """Leave for the halves of an interval only the obstacles that may be too near to segment `k` in it."""
    start, begins = _begin_segment(motion, sweep, interval, k, accuracy.mount)
    part = 1.0 - start
    if part > 0.0:
        radius = motion.limits[k, RADIUS]
        whole = _piece(sweep, interval, k, radius, start + 0.5 * part, part, begins, accuracy.mount)
        sweep.counts[interval.level + 1, k] = _narrow(motion, sweep, interval, whole, accuracy, seen)


def clear_segment(motion: Motion, sweep: Sweep, interval: Interval, k: int, accuracy: Accuracy, seen: Array) -> int:
    """Prove segment `k` clear during an interval; the obstacles that cannot be decided are left for its halves.

    Returns the verdict, and keeps in `seen` (6,) what was found. TOUCHING ends the work: nothing proves the interval.
    """
    counts, level = sweep.counts, interval.level
    start, begins = _begin_segment(motion, sweep, interval, k, accuracy.mount)
    part = 1.0 - start
    if part <= 0.0:
        return CLEAR
    radius, scene = motion.limits[k, RADIUS], motion.scene
    whole = _piece(sweep, interval, k, radius, start + 0.5 * part, part, begins, accuracy.mount)
    count = _narrow(motion, sweep, interval, whole, accuracy, seen)
    deep = number = 0
    while count > 0 and number < 1 << deep:
        piece = whole
        if deep > 0:
            width = part / (1 << deep)
            piece = _piece(sweep, interval, k, radius, start + (number + 0.5) * width, width, begins, accuracy.mount)
        verdict, space, time, units = _decide(scene, sweep, interval, piece, count, accuracy, seen)
        if verdict == TOUCHING:
            counts[level + 1, k] = count
            return TOUCHING
        if spend(sweep.clock, units):
            return UNDECIDED
        if verdict == CLEAR:
            deep, number = following(deep, number)
        elif space > time and 2.0 * piece.half > accuracy.finest:
            deep, number = deep + 1, 2 * number
        else:
            counts[level + 1, k] = count
            return UNDECIDED
    return CLEAR
