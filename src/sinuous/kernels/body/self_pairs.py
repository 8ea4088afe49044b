"""Pairs of segments that may touch each other, and the places where such a pair is closest.

The *gap* of two places of the backbone is their distance less both radii. All two places concern each other but those
that are neighbours along the body:

- Where the radius is the same all the way between them: places whose distance along the body is less than pi radii.
- Where it changes between them: places each of which lies ahead of the other. Along the tangent at the first, towards
  the tip, the second is farther on; along the tangent at the second, towards the base, the first is. So are all places
  between which the body turns by less than a quarter turn.

For no curvature above 1 / radius the first is just when the tube does not overlap itself: the thickness of a tube
(Cantarella, Kusner & Sullivan 2002). There the second rule would say the same. It takes the place of the first because
the end of a thick part reaches beyond what comes after it, however straight the body is.

In a run of segments of one radius r most pairs can be passed over. Curve and chord between two places close to a loop
that turns by 2 pi or more (Fenchel). So where the tangent turns by less than pi between them, one of them comes nearer
to the other when it moves towards it along the backbone, and a pair that is pi r apart is nearer. Those are no nearer
than on a circle of the largest curvature (Schur): one number bounds them all. By Fenchel's
theorem, too, the angles between chord and both tangents add up to no more than the turn between two places: less than a
quarter turn leaves each ahead of the other.
"""

import math
from collections import namedtuple

from sinuous.kernels.body.chords import arc_chord
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.maths.vectors import Array, Vec, add, add_scaled, norm, scale, sub
from sinuous.kernels.tables import BODY, LINK, ONWARD, RIGID, SELF_RADIUS, TOUCHES

ALONG, TURNED, CURVATURE, RUN, FIRST_PARTNER = range(5)
"""Columns of `spans`, a row a segment and one more for the tip: length and turn (rad) of the backbone before the
segment, with the straight ways between joints (of a link up to the last joint, see `begin_of`); its curvature; the
number of its run, which is a row of neighbours of the same radius; the first segment, not before itself, that it may
have to be examined with."""

SPAN_WIDTH = 5

Shape = namedtuple("Shape", ["limits", "q", "frames", "spans"])
"""Rows of segments (n, 35), configuration (n, 3), frames (n + 1, 12), and `spans` (n + 1, 5), which `survey` fills."""

HALF_TURN, QUARTER_TURN = math.pi - 1e-9, 0.5 * math.pi - 1e-9
"""Turn (rad) from which on places are examined: of one run, and of two."""

NO_LENGTH = 1e-300

KINK = 10.0
"""What the turn at the end of a link counts, in rad: more than any that excludes that two places concern each other."""

Meeting = tuple[int, float, int, float]
"""Two places of the body: segment and fraction of it, segment and fraction; segments are -1 where none are known."""


def survey(shape: Shape) -> tuple[float, float]:
    """Fill `shape.spans`; return the bound of the gaps that are passed over, and the largest radius.

    The bound is infinite where no run is as long as half a circle of its radius.
    """
    limits, q, spans = shape.limits, shape.q, shape.spans
    n = q.shape[0]
    most, thickest = math.inf, 0.0
    along = turned = begun = tightest = 0.0
    run = 0
    for k in range(n):
        radius, length = limits[k, SELF_RADIUS], q[k, 2]
        if limits[k, RIGID] != LINK and limits[k, ONWARD] > 0.0:
            along += limits[k, ONWARD]
            begun = along
        if k > 0 and (radius != limits[k - 1, SELF_RADIUS] or limits[k - 1, RIGID] != 0.0):
            most = min(most, least_of_run(limits[k - 1, SELF_RADIUS], along - begun, tightest))
            run, begun, tightest = run + 1, along, 0.0
        bend = math.sqrt(q[k, 0] * q[k, 0] + q[k, 1] * q[k, 1])
        curvature = bend / max(length, NO_LENGTH)
        spans[k, ALONG], spans[k, TURNED], spans[k, CURVATURE], spans[k, RUN] = along, turned, curvature, run
        turned += bend
        if limits[k, RIGID] != 0.0:
            turned += KINK
        if limits[k, RIGID] != LINK:
            along += length
        tightest, thickest = max(tightest, curvature), max(thickest, radius)
    spans[n, ALONG], spans[n, TURNED], spans[n, CURVATURE], spans[n, RUN] = along, turned, 0.0, run
    first = 0
    for k in range(n):
        if run == 0:
            while first < n and spans[first + 1, TURNED] - spans[k, TURNED] < HALF_TURN:
                first += 1
        spans[k, FIRST_PARTNER] = first if run == 0 else k
    return min(most, least_of_run(limits[n - 1, SELF_RADIUS], along - begun, tightest)), thickest


def begin_of(shape: Shape, k: int) -> float:
    """Where segment `k` begins along the backbone; of a link, less than where any place of it is."""
    along = float(shape.spans[k, ALONG])
    return along - float(shape.limits[k, ONWARD]) if shape.limits[k, RIGID] == LINK else along


def end_of(shape: Shape, k: int) -> float:
    """Where segment `k` ends along the backbone; of a link, more than where any place of it is."""
    along = float(shape.spans[k, ALONG])
    return along + float(shape.limits[k, ONWARD] if shape.limits[k, RIGID] == LINK else shape.q[k, 2])


def least_of_run(radius: float, length: float, curvature: float) -> float:
    """Lower bound of the gap of places pi radii apart along a run of this length and of no more than this curvature."""
    apart = math.pi * radius
    if radius <= 0.0 or length < apart:
        return math.inf
    return arc_chord(curvature, apart) - 2.0 * radius


def enough_between(shape: Shape, i: int, j: int) -> float:
    """Turn (rad) between places of segments i < j from which on these are examined."""
    return HALF_TURN if shape.spans[i, RUN] == shape.spans[j, RUN] else QUARTER_TURN


def middle_of(shape: Shape, k: int) -> Vec:
    """Middle of the chord of segment k, from which no point of it is farther than half its length."""
    rotation, position = frame(shape.frames, k)
    if shape.limits[k, RIGID] != 0.0:
        return add_scaled(position, 0.5 * shape.q[k, 2], (rotation[0][2], rotation[1][2], rotation[2][2]))
    return scale(0.5, add(position, frame(shape.frames, k + 1)[1]))


def may_touch(limits: Array, i: int, j: int) -> bool:
    """Whether rows i < j never concern each other: one has no body, or they belong to links that may touch."""
    if limits[i, RIGID] == 0.0:
        return False
    if limits[i, SELF_RADIUS] < 0.0 or limits[j, SELF_RADIUS] < 0.0:
        return True
    return bool((int(limits[i, TOUCHES]) >> int(limits[j, BODY])) & 1)


def next_pair(shape: Shape, i: int, j: int, level: float, thickest: float) -> tuple[int, int, float]:
    """The first pair of segments after (i, j), i <= j, that may have a gap below `level`; (n, n): there is none.

    Also returns a lower bound of the gaps of all that were passed over, infinite where there were none. The first pair
    comes after (-1, n).
    """
    limits, q, spans = shape.limits, shape.q, shape.spans
    n = q.shape[0]
    low = math.inf
    while True:
        j += 1
        while j >= n:
            i += 1
            if i >= n:
                return n, n, low
            j = int(spans[i, FIRST_PARTNER]) if limits[i, SELF_RADIUS] >= 0.0 else n
        if j == i:
            if meets_itself(shape, i):
                return i, i, low
            continue
        if may_touch(limits, i, j):
            continue
        needed = limits[i, SELF_RADIUS] + limits[j, SELF_RADIUS]
        if needed == 0.0 or spans[j + 1, TURNED] - spans[i, TURNED] < enough_between(shape, i, j):
            continue
        sure = norm(sub(middle_of(shape, i), middle_of(shape, j))) - 0.5 * (q[i, 2] + q[j, 2]) - needed
        if sure < level:
            return i, j, low
        low = level
        # What follows within this length of backbone is far enough away, too.
        near = begin_of(shape, j) if limits[j, RIGID] == LINK else end_of(shape, j)
        reached = near + sure - level - (thickest - limits[j, SELF_RADIUS])
        while j + 1 < n and end_of(shape, j + 1) <= reached:
            j += 1


def meets_itself(shape: Shape, i: int) -> bool:
    """Whether segment `i` alone turns far enough to come back to itself."""
    radius = shape.limits[i, SELF_RADIUS]
    turn = shape.spans[i + 1, TURNED] - shape.spans[i, TURNED]
    if shape.limits[i, RIGID] != 0.0:
        return False
    return bool(radius > 0.0 and turn >= HALF_TURN and shape.q[i, 2] >= math.pi * radius)


def own_gap(shape: Shape, i: int) -> tuple[float, float]:
    """Least gap between the beginning of segment `i` and another place of it, and the fraction of that place."""
    radius, length, curvature = shape.limits[i, SELF_RADIUS], shape.q[i, 2], shape.spans[i, CURVATURE]
    if curvature * radius > 1.0:
        return arc_chord(curvature, math.pi * radius) - 2.0 * radius, math.pi * radius / length
    return arc_chord(curvature, length) - 2.0 * radius, min(1.0, 2.0 * math.pi / (curvature * length))
