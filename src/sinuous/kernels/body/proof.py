"""The proof that the whole body is clear of every obstacle.

A distance field is 1-Lipschitz: it changes by at most the distance moved. Of a piece of backbone of arc length h, no
point is farther than h / 2 from the midpoint, so `distance(midpoint) - h / 2 - radius` bounds the clearance of the
piece from below. Pieces are halved until that bound decides. Obstacles that a whole segment is clear of are not asked
again for its pieces. Where an obstacle has samples, their lower bound is tried first; the exact distance is asked only
where that bound is what keeps a piece from being decided.

Close to a convex primitive that would take pieces as short as the clearance. Its distance is a convex function: on a
chord it is no less than its tangent at the middle says at the worse end, and the piece is no farther from its chord
than its sagitta. Both are of second order in h where the tangent is across the gradient, as it is at the closest place.
The same is true of each triangle of a mesh, and of each ball of a cloud.

`among` (m,) int64 holds numbers of obstacles.
"""

import math

from sinuous.kernels.body.chords import sagitta_bound
from sinuous.kernels.body.pieces import (
    BEYOND,
    MANY,
    Scratch,
    backbone_of,
    closest,
    evaluate_here,
    few_near,
    following,
    free_part,
    near,
    work_among,
)
from sinuous.kernels.chain.kinematics import body_point, frame
from sinuous.kernels.clock import spend
from sinuous.kernels.compile import shared
from sinuous.kernels.fields.distances import Scene, bound_patch, tangents_pay
from sinuous.kernels.fields.primitives import Patch
from sinuous.kernels.fields.solids import EXACT, LOWER_BOUND
from sinuous.kernels.maths.vectors import Array, Vec, add, norm, scale, sub
from sinuous.kernels.tables import RADIUS, ROUNDOFF, TAIL_LENGTH

BODY_ROUNDING = 1e-13
"""What arithmetic may be wrong by, relative to how far the body is from the origin of the world. What it makes of the
coordinates of an obstacle is in the row of that: `tables.ROUNDOFF`."""

LOOSENESS = 2.0
"""How much of half a piece the samples may leave open before the exact distance is asked for, not a shorter piece."""

CLEAR, TOUCHING, UNDECIDED = 0, 1, 2
"""Verdicts."""


def _decided(sure: float, least: float, slack: float) -> bool:
    """Whether a bound proves something, and as much as is worth proving when `least` is the best that can be true."""
    return sure > 0.0 and sure >= (1.0 - slack) * least


def rounding_of(limits: Array, q: Array, frames: Array) -> float:
    """What arithmetic may make of a place of the body (length unit), for how far it is from the origin of the world."""
    far = norm(frame(frames, 0)[1])
    for k in range(q.shape[0]):
        far += q[k, 2] + limits[k, TAIL_LENGTH]
    return BODY_ROUNDING * far


def _exact(scene: Scene, i: int, d: float, most: float) -> bool:
    """Whether nothing but arithmetic is between a lower bound of the distance to obstacle `i` and an upper one."""
    return bool(i >= 0 and most - d <= 1.01 * scene.table[i, ROUNDOFF])


def _by_tangents(
    scene: Scene,
    among: Array,
    count: int,
    middle: Vec,
    ends: tuple[Vec, Vec],
    half: float,
    sagitta: float,
    closest_one: tuple[float, int],
    wanted: float,
) -> float:
    """Lower bound of the distance of a piece, of arc length 2 `half`, to the first `count` obstacles of `among`.

    `middle`: the place in its middle; `ends`: those of its ends; `closest_one`: what is known of the distance of the
    place in the middle, and the obstacle that it is to; `wanted`: the bound that proves something.
    """
    nothing, least = (0.0, 0.0, 0.0), math.inf
    if count == MANY:  # who is farther than all of the piece can be decides nothing
        count, _ = near(scene, middle, BEYOND * (closest_one[0] + half), among)
    patch = Patch(scale(0.5, add(ends[0], ends[1])), scale(0.5, sub(ends[1], ends[0])), nothing, nothing)
    for j in range(count):
        i, roundoff = among[j], scene.table[among[j], ROUNDOFF]
        d = closest_one[0]
        if i != closest_one[1]:
            d = evaluate_here(scene, i, middle, least + half + roundoff, LOWER_BOUND)[0] - roundoff
        low = d - half
        if low < least and d > 0.0 and tangents_pay(scene, i, d, half, d - sagitta - wanted):
            low = max(low, bound_patch(scene, i, patch, sagitta, least + roundoff)[0] - roundoff)
        least = min(least, low)
    return least


@shared
def prove(
    limits: Array, q: Array, frames: Array, scene: Scene, mount: float, slack: float, finest: float, scratch: Scratch
) -> tuple[int, float, int, float, int]:
    """Prove that the whole body is clear of every obstacle, or find where it is not.

    Returns the verdict (CLEAR, TOUCHING, UNDECIDED), the clearance, and where the worst was seen: segment, fraction,
    obstacle. With CLEAR the clearance is a lower bound, at most `slack` of it below the truth; otherwise it is the
    least one that was seen. Pieces shorter than `finest` are not halved any more. When the time of the clock in
    `scratch` is over, the verdict is UNDECIDED.
    """
    bound = least = math.inf
    where, fraction, which = -1, 0.0, -1
    undecided = False
    rounding = rounding_of(limits, q, frames)
    among, clock = scratch.among, scratch.clock
    for k in range(q.shape[0]):
        start, length, radius = free_part(limits, q, k, mount), q[k, 2], limits[k, RADIUS]
        mount -= backbone_of(limits, q, k)
        part = 1.0 - start
        if part <= 0.0 or radius < 0.0:  # there is nothing, or it has no body
            continue
        if spend(clock, scene.table.shape[0]):
            return UNDECIDED, least, where, fraction, which
        # Whoever is farther than the best clearance so far cannot matter to any piece of this segment.
        reach = 0.5 * length * part + radius + rounding
        count, rest = few_near(scene, body_point(q, frames, k, start + 0.5 * part), reach + max(0.0, least), among)
        bound = min(bound, rest - reach)
        units = work_among(scene, among, count)
        level, piece = 0, 0
        while count != 0 and piece < 1 << level:
            if spend(clock, units):
                return UNDECIDED, least, where, fraction, which
            width = part / (1 << level)
            s = start + (piece + 0.5) * width
            half = 0.5 * length * width
            p = body_point(q, frames, k, s)
            away = max(0.0, least) + half + radius + rounding
            d, most, nearest_one = closest(scene, among, count, p, away, LOWER_BOUND)
            sure = d - half - radius - rounding
            decided = _decided(sure, min(least, most - radius), slack)
            if not decided and most > d and (most - d > LOOSENESS * half or 2.0 * half <= finest):
                d, most, nearest_one = closest(scene, among, count, p, away, EXACT)
                sure = d - half - radius - rounding
                decided = _decided(sure, min(least, most - radius), slack)
            bend = width * math.hypot(q[k, 0], q[k, 1])
            sagitta = sagitta_bound(2.0 * half, bend) if bend <= math.pi else math.inf
            low = d - sagitta - radius - rounding
            if not decided and _decided(low, min(least, most - radius), slack):
                ends = body_point(q, frames, k, s - 0.5 * width), body_point(q, frames, k, s + 0.5 * width)
                wanted = (1.0 - slack) * max(0.0, min(least, most - radius)) + radius + rounding
                by_tangents = _by_tangents(scene, among, count, p, ends, half, sagitta, (d, nearest_one), wanted)
                sure = max(sure, by_tangents - radius - rounding)
                decided = _decided(sure, min(least, most - radius), slack)
            if most - radius < least:
                least, where, fraction, which = most - radius, k, s, nearest_one
            if least < 0.0 or (not decided and d <= radius + rounding and _exact(scene, nearest_one, d, most)):
                # The place is in an obstacle, or so close to it that no shorter piece about it can be proved.
                return TOUCHING if least < 0.0 else UNDECIDED, least, where, fraction, which
            if 2.0 * half > finest and not decided:
                level, piece = level + 1, 2 * piece
                continue
            undecided = undecided or sure <= 0.0
            bound = min(bound, sure)
            level, piece = following(level, piece)
    if undecided:
        return UNDECIDED, least, where, fraction, which
    return CLEAR, bound, where, fraction, which
