"""Where two segments of the body are nearest to each other, at rest or on the way from one shape to another.

Both segments are halved until bounds decide. A body at rest is on its way from a shape to the same shape, in no time.

On the way both segments are examined from a junction between them. Seen from there only what turns in between moves
them, so within an interval of duration h a place stays within `h^2 A / 8` of the chord of its path, with an `A` that
begins at that junction, see `chain.rates`. So all differences of places of two pieces, at all times of the interval,
are within both sagittas and both of these bounds of the hull of eight: of the ends of the pieces at the ends of the
interval. A direction in which all eight are far enough from 0 proves the pieces apart.

`rates` (n, 5) are those of `chain.rates`.
"""

import math
from collections import namedtuple

from sinuous.kernels.body.chords import arc_chord, find_closest, sagitta_bound
from sinuous.kernels.body.pieces import following
from sinuous.kernels.body.self_pairs import ALONG, CURVATURE, RUN, TURNED, Meeting, Shape, enough_between, own_gap
from sinuous.kernels.chain.kinematics import frame, place_on, tangent
from sinuous.kernels.chain.rates import BEND_RATE, LENGTH_RATE, TURNING, added_acceleration
from sinuous.kernels.maths.vectors import TINY, Array, Vec, add, add_scaled, dot, norm, scale, sub, vec_mat
from sinuous.kernels.tables import LINK, ONWARD, RIGID, SELF_RADIUS, TAIL_LENGTH

Swept = namedtuple("Swept", ["first", "last", "rates", "begin", "h"])
"""The body during an interval of time: its shapes (`Shape`) when that begins and ends, `rates` (n, 5) of the whole
motion, and when it begins and how long it is, in times of the whole motion. At rest both shapes are one, the duration
is 0, and nobody reads the rates."""

GapAccuracy = namedtuple("GapAccuracy", ["unseen", "most", "least", "slack", "floor", "finest", "rounding", "first"])
"""How closely gaps are to be known. A lower bound of them is good enough when it is above `least` and no less than
`unseen`, where no gap is known; else than `most`, or than the least known gap less `slack` of it and `floor`. Pieces
shorter than `finest` are not halved; `rounding` is what arithmetic may be wrong by. With `first` the first overlap is
enough. All are lengths, but for `slack`."""

GAP_SLACK = 0.1
"""How far below the true gap its bound may be at rest, as a share of it."""

NO_CURVE = 1e300
"""Curvature of what is no curve."""

MOST_PAIRS_OF_PIECES = 4000
"""Most pairs of pieces that are examined for one pair of segments."""

Pair = namedtuple("Pair", ["i", "j", "needed", "enough", "tightest", "stepped", "junction", "back", "ahead"])
"""Two segments i < j; the sum of their radii; the turn (rad) between places from which on these may concern each other;
the largest curvature between the segments; whether the radius changes between them. On the way also the junction from
which they are examined, and the rate of turning W and the acceleration A where each of them begins, seen from there;
at rest the junction is -1: they are examined from the world."""

Pieces = tuple[float, float, float, float]
"""A piece of each of two segments: where it begins and how long it is, in fractions of its segment."""

Nearest = tuple[float, float, float, float, float, int]
"""A lower bound of the gaps of two segments (infinite: none counts); the least that was seen, the fractions of both
segments and the time where that was; and how many pairs of pieces were examined."""


def gap_at_rest(shape: Shape, i: int, j: int, accuracy: GapAccuracy, least: float) -> tuple[float, float, Meeting, int]:
    """Lower bound of the gaps of segments i <= j of a body at rest; the least that was seen, where, and the effort.

    `least`: the least gap that is known of others. The effort in pairs of pieces; none, of a segment with itself.
    """
    if i == j:
        gap, t = own_gap(shape, i)
        return gap, gap, (i, 0.0, i, t), 0
    still = Swept(shape, shape, shape.q, 0.0, 0.0)
    low, gap, s, t, _, evaluations = nearest_places(still, pair_of(still, i, j), accuracy, least)
    return low, gap, (i, s, j, t), evaluations


def _good_enough(accuracy: GapAccuracy, low: float, least: float) -> bool:
    """Whether a lower bound of gaps is as good as it has to be where `least` is the least gap that is known."""
    wanted = accuracy.unseen
    if least < math.inf:
        wanted = min(accuracy.most, least - accuracy.slack * abs(least) - accuracy.floor)
    return bool(low > accuracy.least and low >= wanted)


def _junction(rates: Array, i: int, j: int) -> int:
    """The junction between segments i < j with as much turning before as after, about: the segment that it begins."""
    half = 0.5 * (rates[i, TURNING] + rates[j, TURNING] + rates[j, BEND_RATE])
    junction = i + 1
    while junction < j and rates[junction, TURNING] + 0.5 * rates[junction, BEND_RATE] < half:
        junction += 1
    return junction


def _longest(swept: Swept, k: int) -> float:
    """Largest length of segment `k` in the interval."""
    return max(swept.first.q[k, 2], swept.last.q[k, 2])


def _past(swept: Swept, begin: int, end: int, step: int) -> tuple[float, float]:
    """W and A past the segments from `begin` on, up to where that at `end` begins; of a link, up to all of it."""
    rates, limits = swept.rates, swept.first.limits
    turning = acceleration = onward = 0.0  # `onward`: from the last that moves to the next one
    for k in range(begin, end, step):
        if limits[k, RIGID] == LINK:
            continue
        acceleration += (limits[k, ONWARD] if step > 0 else onward) * turning * turning
        acceleration += added_acceleration(turning, rates[k, BEND_RATE], rates[k, LENGTH_RATE], _longest(swept, k), 1.0)
        turning, onward = turning + rates[k, BEND_RATE], limits[k, ONWARD]
    if step > 0 or limits[end, RIGID] == LINK:
        acceleration += limits[end, ONWARD] * turning * turning
    if step < 0:
        acceleration += onward * turning * turning
    return turning, acceleration


def pair_of(swept: Swept, i: int, j: int) -> Pair:
    """Put together what is known of segments i < j in an interval."""
    first, last = swept.first, swept.last
    needed = first.limits[i, SELF_RADIUS] + first.limits[j, SELF_RADIUS]
    stepped = first.spans[i, RUN] != first.spans[j, RUN]
    tightest = 0.0
    for k in range(i, j + 1):
        tightest = max(tightest, first.spans[k, CURVATURE], last.spans[k, CURVATURE])
    junction, back, ahead = -1, (0.0, 0.0), (0.0, 0.0)
    if swept.h > 0.0:
        junction = _junction(swept.rates, i, j)
        back, ahead = _past(swept, junction - 1, i, -1), _past(swept, junction, j, 1)
    if first.limits[i, RIGID] != 0.0:  # what stands at any angle has no curvature between, and nothing is ahead of it
        return Pair(i, j, needed, 0.0, NO_CURVE, False, junction, back, ahead)
    return Pair(i, j, needed, enough_between(first, i, j), tightest, stepped, junction, back, ahead)


def _every_second_bit(x: int) -> int:
    """The bits of `x` at even places, put together."""
    x &= 0x5555555555555555
    x = (x | (x >> 1)) & 0x3333333333333333
    x = (x | (x >> 2)) & 0x0F0F0F0F0F0F0F0F
    x = (x | (x >> 4)) & 0x00FF00FF00FF00FF
    x = (x | (x >> 8)) & 0x0000FFFF0000FFFF
    return (x | (x >> 16)) & 0x00000000FFFFFFFF


def _pieces_of(level: int, piece: int) -> Pieces:
    """The pieces after `level` halvings, of the first segment and the second in turn; `piece` has a bit for each."""
    newer, older = _every_second_bit(piece), _every_second_bit(piece >> 1)
    u, v = 1.0 / (1 << ((level + 1) >> 1)), 1.0 / (1 << (level >> 1))
    if level & 1:
        return u * newer, u, v * older, v
    return u * older, u, v * newer, v


def _amount_between(shape: Shape, pair: Pair, column: int, s: float, t: float) -> float:
    """How much of a column of the spans lies between the fractions s and t of the segments of a pair."""
    spans, i, j = shape.spans, pair.i, pair.j
    begin = spans[i, column] + s * (spans[i + 1, column] - spans[i, column])
    return float(spans[j, column] + t * (spans[j + 1, column] - spans[j, column]) - begin)


def _most_between(swept: Swept, pair: Pair, column: int, s: float, t: float) -> float:
    """The most of that in the interval: it is at an end of it, for turns are convex in time, lengths linear."""
    return max(_amount_between(swept.first, pair, column, s, t), _amount_between(swept.last, pair, column, s, t))


def _by_circle(swept: Swept, pair: Pair, pieces: Pieces) -> float:
    """Lower bound of the gap of two pieces, from the curvature between them."""
    a, _, b, v = pieces
    far = _most_between(swept, pair, ALONG, a, b + v)
    if pair.tightest * far >= 2.0 * math.pi or pair.tightest == NO_CURVE:
        return -math.inf
    # The chord of a circle is least where one of both ends is: the least turn that counts, or the whole way.
    return min(arc_chord(pair.tightest, far), arc_chord(pair.tightest, pair.enough / pair.tightest)) - pair.needed


def _place_on(shape: Shape, k: int, s: float) -> Vec:
    """A place of the body."""
    return place_on(shape.q, shape.frames, shape.limits[k, TAIL_LENGTH], k, s)


def _from_junction(shape: Shape, pair: Pair, k: int, s: float) -> Vec:
    """A place of the body, as it is seen from the junction of a pair."""
    place = _place_on(shape, k, s)
    if pair.junction < 0:
        return place
    rotation, position = frame(shape.frames, pair.junction)
    return vec_mat(sub(place, position), rotation)


def _tangent_from_junction(shape: Shape, pair: Pair, k: int, s: float) -> Vec:
    """The tangent at a place of the body, as it is seen from the junction of a pair."""
    along = tangent(shape.q, shape.frames, k, s)
    return along if pair.junction < 0 else vec_mat(along, frame(shape.frames, pair.junction)[0])


def _lag(swept: Swept, pair: Pair, pieces: Pieces) -> float:
    """How far differences of places of two pieces may be from the chords of their paths."""
    if pair.junction < 0:
        return 0.0
    rates, i, j, a, t = swept.rates, pair.i, pair.j, pieces[0], pieces[2] + pieces[3]
    back = added_acceleration(pair.back[0], rates[i, BEND_RATE], rates[i, LENGTH_RATE], _longest(swept, i), 1.0 - a)
    ahead = added_acceleration(pair.ahead[0], rates[j, BEND_RATE], rates[j, LENGTH_RATE], _longest(swept, j), t)
    return float(0.125 * swept.h * swept.h * (pair.back[1] + back + pair.ahead[1] + ahead))


def _bend(swept: Swept, k: int) -> float:
    """Largest bend (rad) of segment `k` in the interval."""
    if swept.first.limits[k, RIGID] != 0.0:
        return 0.0
    first, last = swept.first.spans, swept.last.spans
    return float(max(first[k + 1, TURNED] - first[k, TURNED], last[k + 1, TURNED] - last[k, TURNED]))


def _by_corners(swept: Swept, pair: Pair, pieces: Pieces) -> tuple[float, float, float, float, float]:
    """Lower bound of the gap of two pieces; what place and time leave open of it; where they seem to be nearest."""
    a, u, b, v = pieces
    i, j, first, last = pair.i, pair.j, swept.first, swept.last
    bend_i, bend_j = u * _bend(swept, i), v * _bend(swept, j)
    if max(bend_i, bend_j) > math.pi:
        return -math.inf, math.inf, 0.0, a + 0.5 * u, b + 0.5 * v
    sagittas = sagitta_bound(u * _longest(swept, i), bend_i) + sagitta_bound(v * _longest(swept, j), bend_j)
    p0, p1 = _from_junction(first, pair, i, a), _from_junction(first, pair, i, a + u)
    r0, r1 = _from_junction(first, pair, j, b), _from_junction(first, pair, j, b + v)
    p2, p3, r2, r3 = p0, p1, r0, r1
    if pair.junction >= 0:
        p2, p3 = _from_junction(last, pair, i, a), _from_junction(last, pair, i, a + u)
        r2, r3 = _from_junction(last, pair, j, b), _from_junction(last, pair, j, b + v)
    p, pp = scale(0.5, add(p0, p2)), scale(0.5, add(p1, p3))
    r, rr = scale(0.5, add(r0, r2)), scale(0.5, add(r1, r3))
    s, t = find_closest(p, pp, r, rr)
    across = sub(add_scaled(r, t, sub(rr, r)), add_scaled(p, s, sub(pp, p)))
    g = scale(1.0 / (norm(across) + TINY), across)
    x0, x1, x2, x3 = dot(g, p0), dot(g, p1), dot(g, p2), dot(g, p3)
    y0, y1, y2, y3 = dot(g, r0), dot(g, r1), dot(g, r2), dot(g, r3)
    low = min(min(y0, y1) - max(x0, x1), min(y2, y3) - max(x2, x3))
    lag = _lag(swept, pair, pieces)
    space = sagittas + 0.5 * max(abs(x1 - x0) + abs(y1 - y0), abs(x3 - x2) + abs(y3 - y2))
    moved = max(max(y2 - y0, y3 - y1) - min(x2 - x0, x3 - x1), max(x2 - x0, x3 - x1) - min(y2 - y0, y3 - y1))
    return low - sagittas - lag - pair.needed, space, lag + 0.5 * moved, a + s * u, b + t * v


def _ahead(swept: Swept, pair: Pair, pieces: Pieces) -> tuple[float, float, float]:
    """Lower bound of how far places of two pieces lie ahead of each other; what place and time leave open of it.

    All differences of places are within `reach` and `lag` of those of the middles of both chords, when the interval
    begins and when it ends. Tangents are within half the bend of a piece, and what turns meanwhile, of that in its
    middle.
    """
    a, u, b, v = pieces
    i, j, first, last = pair.i, pair.j, swept.first, swept.last
    e0 = _across(first, pair, pieces)
    e1 = _across(last, pair, pieces) if pair.junction >= 0 else e0
    reach, lag = 0.5 * (u * _longest(swept, i) + v * _longest(swept, j)), _lag(swept, pair, pieces)
    far = max(norm(e0), norm(e1)) + reach + lag
    along_i, along_j = (
        _tangent_from_junction(first, pair, i, a + 0.5 * u),
        _tangent_from_junction(first, pair, j, b + 0.5 * v),
    )
    turning_i = turning_j = 0.0
    if pair.junction >= 0:
        turning_i = swept.h * (pair.back[0] + swept.rates[i, BEND_RATE])
        turning_j = swept.h * (pair.ahead[0] + swept.rates[j, BEND_RATE])
    space = reach + 0.5 * far * max(u * _bend(swept, i), v * _bend(swept, j))
    time = lag + far * max(turning_i, turning_j)
    center = min(dot(e0, along_i), dot(e1, along_i), dot(e0, along_j), dot(e1, along_j))
    return center - space - time, space, time


def _across(shape: Shape, pair: Pair, pieces: Pieces) -> Vec:
    """From the middle of the chord of one piece to that of the other."""
    a, u, b, v = pieces
    first = add(_from_junction(shape, pair, pair.i, a), _from_junction(shape, pair, pair.i, a + u))
    return scale(
        0.5, sub(add(_from_junction(shape, pair, pair.j, b), _from_junction(shape, pair, pair.j, b + v)), first)
    )


def _concern(shape: Shape, pair: Pair, s: float, t: float) -> bool:
    """Whether the fractions s and t of the segments of a pair concern each other."""
    if _amount_between(shape, pair, TURNED, s, t) < pair.enough:
        return False
    if not pair.stepped:
        return True
    across = sub(_place_on(shape, pair.j, t), _place_on(shape, pair.i, s))
    here, there = tangent(shape.q, shape.frames, pair.i, s), tangent(shape.q, shape.frames, pair.j, t)
    return bool(dot(across, here) <= 0.0 or dot(across, there) <= 0.0)


def _gap_at(swept: Swept, pair: Pair, pieces: Pieces, s: float, t: float) -> tuple[float, float, float, float]:
    """Least gap between the fractions s and t of two segments at the ends of an interval, where that is and when.

    Where these do not concern each other, the places of their pieces that are farthest apart along the body are taken.
    Infinite where these do not, either.
    """
    least, at, on, when = math.inf, s, t, swept.begin
    for at_end in range(2 if pair.junction >= 0 else 1):
        shape = swept.last if at_end else swept.first
        here, there = s, t
        if not _concern(shape, pair, here, there):
            here, there = pieces[0], pieces[2] + pieces[3]
            if not _concern(shape, pair, here, there):
                continue
        first, second = _place_on(shape, pair.i, here), _place_on(shape, pair.j, there)
        gap = norm(sub(first, second)) - pair.needed
        if gap < least:
            least, at, on, when = gap, here, there, swept.begin + at_end * swept.h
    return least, at, on, when


def _bound(
    swept: Swept, pair: Pair, pieces: Pieces, accuracy: GapAccuracy, known: float
) -> tuple[float, float, float, float, float]:
    """Lower bound of the gap of two pieces, infinite where no places of them concern each other.

    Where that is not good enough for the least gap that is `known`: what place and time leave open, and where the
    pieces seem to be nearest.
    """
    sure = _by_circle(swept, pair, pieces) - accuracy.rounding
    if _good_enough(accuracy, sure, known):
        return sure, 0.0, 0.0, 0.5, 0.5
    by_corners, space, time, s, t = _by_corners(swept, pair, pieces)
    sure = max(sure, by_corners - accuracy.rounding)
    if pair.stepped and not _good_enough(accuracy, sure, known):
        ahead, in_space, in_time = _ahead(swept, pair, pieces)
        if ahead > accuracy.rounding:
            return math.inf, 0.0, 0.0, s, t
        if by_corners + space + time <= 0.0:  # then nothing else can decide
            space, time = in_space, in_time
    return sure, space, time, s, t


def nearest_places(swept: Swept, pair: Pair, accuracy: GapAccuracy, least: float) -> Nearest:
    """Bound the gaps of two segments, of those places that concern each other, during an interval.

    What is not below `least`, a gap found elsewhere, is of no interest. On the way the bound is -inf where a part of
    it had to be left open, or where halving the time helps more than halving the segments.
    """
    low = found = math.inf
    at, on, when = 0.5, 0.5, swept.begin
    level = piece = evaluations = 0
    while piece < 1 << level:
        pieces = _pieces_of(level, piece)
        a, u, b, v = pieces
        if _most_between(swept, pair, TURNED, a, b + v) >= pair.enough:
            evaluations += 1
            sure, space, time, s, t = _bound(swept, pair, pieces, accuracy, min(least, found))
            if not _good_enough(accuracy, sure, min(least, found)):
                gap, s, t, then = _gap_at(swept, pair, pieces, s, t)
                if gap < found:
                    found, at, on, when = gap, s, t, then
                if accuracy.first and gap < 0.0:
                    return min(gap, sure), found, at, on, when, evaluations
                if not _good_enough(accuracy, sure, min(least, found)):
                    size = u * _longest(swept, pair.i) + v * _longest(swept, pair.j)
                    if space > time and size > accuracy.finest and evaluations < MOST_PAIRS_OF_PIECES:
                        level, piece = level + 1, 2 * piece
                        continue
                    if pair.junction >= 0:
                        return -math.inf, found, at, on, when, evaluations
            low = min(low, sure)
        level, piece = following(level, piece)
    return low, found, at, on, when, evaluations
