"""The whole body against the scene: contacts that a step has to open, and the proof that there are none.

A distance field changes by at most the distance moved. Of a piece of backbone of arc length h, no point is farther than h / 2
from the midpoint, so `distance(midpoint) - h / 2 - radius` bounds the clearance of the piece from below. Pieces are
halved until that bound decides. Obstacles that a whole segment is clear of are not asked again for its pieces.
"""

import math

from sinuous.kernels.chain import body_columns, body_point
from sinuous.kernels.compile import kernel
from sinuous.kernels.distances import distance, obstacle
from sinuous.kernels.limits import RADIUS
from sinuous.kernels.sweeps import INNER, Rows
from sinuous.kernels.vectors import Array, Vec, cross, dot, put_vec, scale, sub

PER_SEGMENT = 32
"""Most contacts of one segment that enter a step."""

CLEAR, TOUCHING, UNDECIDED = 0, 1, 2


@kernel
def free_part(q: Array, k: int, mount: float) -> float:
    """Fraction of segment `k` that lies within the mount; `mount` is what is left of it at the beginning of the segment."""
    if mount <= 0.0:
        return 0.0
    if mount >= q[k, 2]:
        return 1.0
    return mount / q[k, 2]


@kernel
def near(scene: Array, p: Vec, reach: float, among: Array) -> tuple[int, float]:
    """List in `among` the obstacles closer to `p` than `reach`: their number, and the least distance of the others."""
    count, rest = 0, math.inf
    for i in range(scene.shape[0]):
        d = distance(scene, i, p)
        if d < reach:
            among[count] = i
            count += 1
        elif d < rest:
            rest = d
    return count, rest


@kernel
def contacts(
    limits: Array,
    q: Array,
    frames: Array,
    scene: Array,
    k: int,
    mount: float,
    margin: float,
    depth: int,
    origin: Vec,
    unit: float,
    among: Array,
    rows: Rows,
    at: int,
) -> tuple[int, float]:
    """Write a row for every place of segment `k` that is closer than `margin` to an obstacle, from row `at` on.

    The segment is halved `depth` times where it may be too close. Returns the next free row and the least clearance
    that was seen at a place (infinite: none was looked at closely).
    """
    start, length, radius = free_part(q, k, mount), q[k, 2], limits[k, RADIUS]
    part = 1.0 - start
    least = math.inf
    if part <= 0.0:
        return at, least
    half = 0.5 * length * part
    reach = radius + margin + half
    count, _ = near(scene, body_point(q, frames, k, start + 0.5 * part), reach, among)
    last = at + PER_SEGMENT
    level, piece = 0, 0
    while count > 0:
        width = part / (1 << level)
        s = start + (piece + 0.5) * width
        p = body_point(q, frames, k, s)
        closest = math.inf
        for j in range(count):
            closest = min(closest, distance(scene, among[j], p))
        if level < depth and closest < radius + margin + 0.5 * length * width:
            level, piece = level + 1, 2 * piece
            continue
        least = min(least, closest - radius)
        if closest < radius + margin:
            for j in range(count):
                if at < last:
                    at = _contact(q, frames, scene, among[j], k, s, p, radius + margin, origin, unit, rows, at)
        piece += 1
        while level > 0 and piece & 1 == 0:
            level, piece = level - 1, piece >> 1
        if level == 0:
            break
    return at, least


@kernel
def _contact(
    q: Array,
    frames: Array,
    scene: Array,
    i: int,
    k: int,
    s: float,
    p: Vec,
    wanted: float,
    origin: Vec,
    unit: float,
    rows: Rows,
    at: int,
) -> int:
    d, g = obstacle(scene, i, p)
    if d >= wanted:
        return at
    force = scale(1.0 / unit, g)
    torque = cross(sub(p, origin), force)
    x, y, z = body_columns(q, frames, origin, k, s)
    end = body_columns(q, frames, origin, k, 1.0)
    put_vec(rows.twist, at, 0, torque)
    put_vec(rows.twist, at, 3, force)
    rows.inner[at, 0] = s * (dot(torque, x[0]) + dot(force, x[1])) - dot(torque, end[0][0]) - dot(force, end[0][1])
    rows.inner[at, 1] = s * (dot(torque, y[0]) + dot(force, y[1])) - dot(torque, end[1][0]) - dot(force, end[1][1])
    rows.inner[at, 2] = s * dot(force, z[1]) - dot(force, end[2][1])
    rows.kind[at] = INNER
    rows.value[at] = (wanted - d) / unit
    return at + 1


@kernel
def prove(
    limits: Array, q: Array, frames: Array, scene: Array, mount: float, slack: float, finest: float, among: Array
) -> tuple[int, float, int, float, int]:
    """Prove that the whole body is clear of every obstacle, or find where it is not.

    Returns the verdict (CLEAR, TOUCHING, UNDECIDED), the clearance, and where the worst was seen: segment, fraction, obstacle. With
    CLEAR the clearance is a lower bound, at most `slack` of it below the truth; otherwise it is the least one that was
    seen. Pieces shorter than `finest` are not halved any more.
    """
    bound = least = math.inf
    where, fraction, which = -1, 0.0, -1
    undecided = False
    for k in range(q.shape[0]):
        start, length, radius = free_part(q, k, mount), q[k, 2], limits[k, RADIUS]
        mount -= length
        part = 1.0 - start
        if part <= 0.0:
            continue
        p = body_point(q, frames, k, start + 0.5 * part)
        half = 0.5 * length * part
        # Whoever is farther than the best clearance so far cannot matter to any piece of this segment.
        count, rest = near(scene, p, half + radius + max(0.0, least), among)
        bound = min(bound, max(rest - half - radius, -math.inf))
        level, piece = 0, 0
        while count > 0:
            width = part / (1 << level)
            s = start + (piece + 0.5) * width
            p = body_point(q, frames, k, s)
            half = 0.5 * length * width
            closest, closest_which = math.inf, -1
            for j in range(count):
                d = distance(scene, among[j], p)
                if d < closest:
                    closest, closest_which = d, among[j]
            seen = closest - radius
            if seen < least:
                least, where, fraction, which = seen, k, s, closest_which
            if least < 0.0:
                return TOUCHING, least, where, fraction, which
            if seen - half < (1.0 - slack) * least or seen - half <= 0.0:
                if 2.0 * half > finest:
                    level, piece = level + 1, 2 * piece
                    continue
                if seen - half <= 0.0:
                    undecided = True
            bound = min(bound, seen - half)
            piece += 1
            while level > 0 and piece & 1 == 0:
                level, piece = level - 1, piece >> 1
            if level == 0:
                break
    if undecided:
        return UNDECIDED, least, where, fraction, which
    return CLEAR, bound, where, fraction, which


