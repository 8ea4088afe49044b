"""The whole body against the scene: contacts that a step has to open, and the proof that there are none.

A distance field changes by at most the distance moved. Of a piece of backbone of arc length h, no point is farther
than h / 2 from the midpoint, so `distance(midpoint) - h / 2 - radius` bounds the clearance of the piece from below.
Pieces are halved until that bound decides. Obstacles that a whole segment is clear of are not asked again for its
pieces. Where an obstacle has samples, their lower bound is tried first; the exact distance is asked only where that
bound is what keeps a piece from being decided.
"""

import math

from sinuous.kernels.body.rows import INNER, SOFT, Rows, put_body_row
from sinuous.kernels.chain.kinematics import body_point, frame
from sinuous.kernels.compile import inline, kernel
from sinuous.kernels.fields.distances import Scene, look, slope
from sinuous.kernels.fields.solids import BOUND, EXACT
from sinuous.kernels.maths.vectors import Array, Vec, norm, scale
from sinuous.kernels.tables import RADIUS

PER_SEGMENT = 32
"""Most contacts of one segment that enter a step."""

SOFTNESS = 1e-4
"""Scale of rows that are only wished for; with the least damping, 1e-10, they weigh 100 times a radian."""

ROUNDING = 1e-13
"""What arithmetic may be wrong by, relative to mode far the body is from the origin of the world."""

LOOSENESS = 2.0
"""How much of half a piece the samples may leave open before the exact distance is asked for, not a shorter piece."""

CLEAR, TOUCHING, UNDECIDED = 0, 1, 2


look_here = inline(look)


@kernel
def free_part(q: Array, k: int, mount: float) -> float:
    """Fraction of segment `k` that lies within the mount; `mount` is what is left of it where the segment begins."""
    if mount <= 0.0:
        return 0.0
    if mount >= q[k, 2]:
        return 1.0
    return mount / q[k, 2]


@kernel
def near(scene: Scene, p: Vec, reach: float, among: Array) -> tuple[int, float]:
    """List in `among` the obstacles that may be closer to `p` than `reach`: their number, and a bound of the others."""
    count, rest = 0, math.inf
    for i in range(scene.table.shape[0]):
        d, _ = look_here(scene, i, p, reach, BOUND)
        if d < reach:
            among[count] = i
            count += 1
        elif d < rest:
            rest = d
    return count, rest


@kernel
def following(level: int, piece: int) -> tuple[int, int]:
    """Piece that comes after this one, as large as its place allows; (0, 1) when there is none.

    Piece number `piece` of level `level` is one of `2 ** level` equal parts of the segment.
    """
    piece += 1
    while level > 0 and piece & 1 == 0:
        level, piece = level - 1, piece >> 1
    return level, piece


@kernel
def closest(scene: Scene, among: Array, count: int, p: Vec, reach: float, mode: int) -> tuple[float, float, int]:
    """Least distance of `p` to the first `count` obstacles that `among` lists, an upper bound of it, and the obstacle.

    `mode` to ask, and `reach`, beyond which nobody is interested: see `distances.look`.
    """
    least, most, which = math.inf, math.inf, -1
    for j in range(count):
        d, upper = look_here(scene, among[j], p, min(reach, least), mode)
        most = min(most, upper)
        if d < least:
            least, which = d, among[j]
    return least, most, which


@kernel
def contacts(
    limits: Array,
    q: Array,
    frames: Array,
    scene: Scene,
    k: int,
    mount: float,
    margin: float,
    wish: float,
    depth: int,
    mode: int,
    unit: float,
    among: Array,
    rows: Rows,
    at: int,
) -> tuple[int, float]:
    """Write a row for every place of segment `k` that is closer than `margin` to an obstacle, from row `at` on.

    Between `margin` and `wish` the row is SOFT. The segment is halved `depth` times where it may be too close.
    Distances are asked in this mode, STEP or EXACT.
    Returns the next free row and the least clearance that was seen at a place (infinite: none was looked at closely).
    """
    start, length, radius = free_part(q, k, mount), q[k, 2], limits[k, RADIUS]
    part = 1.0 - start
    least = math.inf
    if part <= 0.0:
        return at, least
    half = 0.5 * length * part
    near_by = radius + max(margin, wish)
    reach = near_by + half
    count, _ = near(scene, body_point(q, frames, k, start + 0.5 * part), reach, among)
    last = at + PER_SEGMENT
    level, piece = 0, 0
    while count > 0 and piece < 1 << level:
        width = part / (1 << level)
        s = start + (piece + 0.5) * width
        p = body_point(q, frames, k, s)
        d, _, _ = closest(scene, among, count, p, near_by + 0.5 * length * width, mode)
        if level < depth and d < near_by + 0.5 * length * width:
            level, piece = level + 1, 2 * piece
            continue
        level, piece = following(level, piece)
        least = min(least, d - radius)
        if d < near_by:
            for j in range(count):
                if at < last:
                    at = _contact(q, frames, scene, among[j], k, s, p, radius + margin, near_by, mode, unit, rows, at)
    return at, least


@kernel
def _contact(
    q: Array,
    frames: Array,
    scene: Scene,
    i: int,
    k: int,
    s: float,
    p: Vec,
    needed: float,
    wished: float,
    mode: int,
    unit: float,
    rows: Rows,
    at: int,
) -> int:
    d, g = slope(scene, i, p, wished, mode)
    if d >= wished:
        return at
    soft = d >= needed
    weight = (SOFTNESS if soft else 1.0) / unit
    value = weight * ((wished if soft else needed) - d)
    return put_body_row(rows, at, q, frames, (k, s, p), scale(weight, g), SOFT if soft else INNER, value)


@kernel
def _decided(sure: float, least: float, slack: float) -> bool:
    """Whether a bound proves something, and as much as is worth proving when `least` is the best that can be true."""
    return sure > 0.0 and sure >= (1.0 - slack) * least


@kernel
def prove(
    limits: Array, q: Array, frames: Array, scene: Scene, mount: float, slack: float, finest: float, among: Array
) -> tuple[int, float, int, float, int]:
    """Prove that the whole body is clear of every obstacle, or find where it is not.

    Returns the verdict (CLEAR, TOUCHING, UNDECIDED), the clearance, and where the worst was seen: segment, fraction,
    obstacle. With CLEAR the clearance is a lower bound, at most `slack` of it below the truth; otherwise it is the
    least one that was seen. Pieces shorter than `finest` are not halved any more.
    """
    bound = least = math.inf
    where, fraction, which = -1, 0.0, -1
    undecided = False
    rounding = norm(frame(frames, 0)[1])
    for k in range(q.shape[0]):
        rounding += q[k, 2]
    rounding *= ROUNDING
    for k in range(q.shape[0]):
        start, length, radius = free_part(q, k, mount), q[k, 2], limits[k, RADIUS]
        mount -= length
        part = 1.0 - start
        if part <= 0.0:
            continue
        # Whoever is farther than the best clearance so far cannot matter to any piece of this segment.
        reach = 0.5 * length * part + radius + rounding
        count, rest = near(scene, body_point(q, frames, k, start + 0.5 * part), reach + max(0.0, least), among)
        bound = min(bound, rest - reach)
        level, piece = 0, 0
        while count > 0 and piece < 1 << level:
            width = part / (1 << level)
            s = start + (piece + 0.5) * width
            half = 0.5 * length * width
            p = body_point(q, frames, k, s)
            away = max(0.0, least) + half + radius + rounding
            d, most, nearest_one = closest(scene, among, count, p, away, BOUND)
            sure = d - half - radius - rounding
            decided = _decided(sure, min(least, most - radius), slack)
            if not decided and most > d and (most - d > LOOSENESS * half or 2.0 * half <= finest):
                d, most, nearest_one = closest(scene, among, count, p, away, EXACT)
                sure = d - half - radius - rounding
                decided = _decided(sure, min(least, most - radius), slack)
            if most - radius < least:
                least, where, fraction, which = most - radius, k, s, nearest_one
            if least < 0.0:
                return TOUCHING, least, where, fraction, which
            if 2.0 * half > finest and not decided:
                level, piece = level + 1, 2 * piece
                continue
            undecided = undecided or sure <= 0.0
            bound = min(bound, sure)
            level, piece = following(level, piece)
    if undecided:
        return UNDECIDED, least, where, fraction, which
    return CLEAR, bound, where, fraction, which
