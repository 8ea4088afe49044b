"""Where two segments of the body are closest to each other: both are halved until bounds decide."""

import math
from collections import namedtuple

from sinuous.kernels.body.chords import arc_chord, chord_distance, sag
from sinuous.kernels.body.pieces import following
from sinuous.kernels.body.self_pairs import ALONG, CURVATURE, HALF_TURN, TURNED, Shape, concern
from sinuous.kernels.chain.kinematics import body_point
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import add, norm, sub
from sinuous.kernels.tables import RADIUS

Aim = namedtuple("Aim", ["most", "floor", "finest", "stop"])
"""How closely gaps are to be known: nothing from `most` on matters, nor what is within a tenth, and `floor`, of the
least. Pieces shorter than `finest` are not halved. With `stop` the first overlap is enough. The others are lengths."""

SLACK = 0.1
"""How far below the true gap its bound may be, as a share of it."""

MOST_LOOKS = 4000
"""Most pairs of pieces that are looked at for one pair of segments."""

Pair = namedtuple("Pair", ["i", "j", "needed", "column", "enough", "tightest"])
"""Two segments i < j; the sum of their radii; which column of the spans says whether places of them are looked at, and
how much of it is needed; the largest curvature between them."""

Pieces = tuple[float, float, float, float]
"""A piece of each of two segments: where it begins and how long it is, in fractions of its segment."""


@kernel
def wanted(aim: Aim, least: float) -> float:
    """Bound from which on a gap need not be known better, when `least` was found."""
    if least == math.inf:
        return float(aim.most)
    return min(aim.most, least - SLACK * abs(least) - aim.floor)


@kernel
def pair_of(shape: Shape, i: int, j: int) -> Pair:
    """Put together what is known of segments i < j."""
    spans = shape.spans
    column, enough = concern(shape, i, j)
    tightest = math.inf  # from a whole turn on, nothing follows from it
    if spans[j + 1, TURNED] - spans[i, TURNED] < 2.0 * math.pi:
        tightest = 0.0
        for k in range(i, j + 1):
            tightest = max(tightest, spans[k, CURVATURE])
    return Pair(i, j, shape.limits[i, RADIUS] + shape.limits[j, RADIUS], column, enough, tightest)


@kernel
def _every_second_bit(x: int) -> int:
    """The bits of `x` at even places, put together."""
    x &= 0x5555555555555555
    x = (x | (x >> 1)) & 0x3333333333333333
    x = (x | (x >> 2)) & 0x0F0F0F0F0F0F0F0F
    x = (x | (x >> 4)) & 0x00FF00FF00FF00FF
    x = (x | (x >> 8)) & 0x0000FFFF0000FFFF
    return (x | (x >> 16)) & 0x00000000FFFFFFFF


@kernel
def pieces_of(level: int, piece: int) -> Pieces:
    """The pieces after `level` halvings, of the first segment and the second in turn; `piece` has a bit for each."""
    newer, older = _every_second_bit(piece), _every_second_bit(piece >> 1)
    u, v = 1.0 / (1 << ((level + 1) >> 1)), 1.0 / (1 << (level >> 1))
    if level & 1:
        return u * newer, u, v * older, v
    return u * older, u, v * newer, v


@kernel
def amount_between(shape: Shape, pair: Pair, column: int, s: float, t: float) -> float:
    """How much of a column of the spans lies between the fractions s and t of the segments of a pair."""
    spans, i, j = shape.spans, pair.i, pair.j
    begin = spans[i, column] + s * (spans[i + 1, column] - spans[i, column])
    return float(spans[j, column] + t * (spans[j + 1, column] - spans[j, column]) - begin)


@kernel
def _by_circle(shape: Shape, pair: Pair, pieces: Pieces) -> float:
    """Lower bound of the gap of two pieces, from the curvature between them."""
    a, u, b, v = pieces
    far = amount_between(shape, pair, ALONG, a, b + v)
    if pair.tightest * far >= 2.0 * math.pi:
        return -math.inf
    apart = arc_chord(pair.tightest, far)
    if pair.column == ALONG:
        apart = min(apart, arc_chord(pair.tightest, max(pair.enough, amount_between(shape, pair, ALONG, a + u, b))))
    elif pair.enough < HALF_TURN:  # from pi on, the chord of a circle only shrinks
        apart = min(apart, arc_chord(pair.tightest, pair.enough / pair.tightest))
    return apart - pair.needed


@kernel
def _by_chords(shape: Shape, pair: Pair, pieces: Pieces, target: float) -> tuple[float, float, float]:
    """Lower bound of the gap of two pieces: from balls about them and, where that is below `target`, from their chords.

    Also returns the fractions of the segments where the chords are closest.
    """
    q, frames, i, j = shape.q, shape.frames, pair.i, pair.j
    a, u, b, v = pieces
    p, r = body_point(q, frames, i, a), body_point(q, frames, i, a + u)
    c, d = body_point(q, frames, j, b), body_point(q, frames, j, b + v)
    li, lj = u * q[i, 2], v * q[j, 2]
    sure = 0.5 * (norm(sub(add(p, r), add(c, d))) - li - lj) - pair.needed
    s = t = 0.5
    if sure < target:
        apart, s, t = chord_distance(p, r, c, d)
        ui = u * (shape.spans[i + 1, TURNED] - shape.spans[i, TURNED])
        uj = v * (shape.spans[j + 1, TURNED] - shape.spans[j, TURNED])
        if max(ui, uj) <= math.pi:
            sure = max(sure, apart - sag(li, ui) - sag(lj, uj) - pair.needed)
    return sure, a + s * u, b + t * v


@kernel
def gap_at(shape: Shape, pair: Pair, s: float, t: float) -> float:
    """Gap between the fractions s and t of the segments of a pair."""
    q, frames = shape.q, shape.frames
    return norm(sub(body_point(q, frames, pair.i, s), body_point(q, frames, pair.j, t))) - pair.needed


@kernel
def closest(shape: Shape, pair: Pair, aim: Aim, least: float) -> tuple[float, float, float, float, int]:
    """Places of two segments with the least gap, of those that concern each other.

    What is not below `least`, a gap found elsewhere, is of no interest. Returns a lower bound of the gaps (infinite:
    there are none), the least that was seen, the fractions of both segments where that was, and how many pairs of
    pieces were looked at.
    """
    i, j = pair.i, pair.j
    bound = found = math.inf
    at = on = 0.5
    level = piece = looks = 0
    while piece < 1 << level:
        pieces = pieces_of(level, piece)
        a, u, b, v = pieces
        if amount_between(shape, pair, pair.column, a, b + v) >= pair.enough:
            looks += 1
            target = wanted(aim, min(least, found))
            sure = _by_circle(shape, pair, pieces)
            if sure < target:
                chords, s, t = _by_chords(shape, pair, pieces, target)
                sure = max(sure, chords)
            if sure < target:
                if amount_between(shape, pair, pair.column, s, t) < pair.enough:
                    s, t = a, b + v
                gap = gap_at(shape, pair, s, t)
                if gap < found:
                    found, at, on = gap, s, t
                if aim.stop and gap < 0.0:
                    return gap, found, at, on, looks
                size = u * shape.q[i, 2] + v * shape.q[j, 2]
                if size > aim.finest and looks < MOST_LOOKS and sure < wanted(aim, min(least, found)):
                    level, piece = level + 1, 2 * piece
                    continue
            bound = min(bound, sure)
        level, piece = following(level, piece)
    return bound, found, at, on, looks
