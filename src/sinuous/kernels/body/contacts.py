"""Contacts: rows of a step that push places of the body away from obstacles that are too near."""

import math
from collections import namedtuple

from sinuous.kernels.body.pieces import MANY, Scratch, closest, few_near, following, free_part, near, work_among
from sinuous.kernels.body.rows import INNER, SOFT, Place, Rows, put_body_row
from sinuous.kernels.chain.kinematics import body_point
from sinuous.kernels.clock import spend
from sinuous.kernels.fields.distances import Scene, slope_known
from sinuous.kernels.fields.solids import EXACT, LOWER_BOUND
from sinuous.kernels.maths.vectors import Vec, scale
from sinuous.kernels.tables import RADIUS

PER_SEGMENT = 32
"""Most contacts of one segment that enter a step."""

SOFTNESS = 1e-4
"""Scale of rows that are only wished for; with their variance, 1e-10, they weigh 100 times a radian."""

PosedBody = namedtuple("PosedBody", ["limits", "q", "frames", "unit"])
"""Rows of segments (n, 35), configuration (n, 3), frames (n + 1, 12), and the length that rows are measured in."""

ContactSearch = namedtuple("ContactSearch", ["margin", "wish", "depth", "mode"])
"""How closely contacts are searched for: clearance that is needed, clearance that is wished for (lengths), how often a
segment is halved where it may be too near, and the mode of the distances, INTERPOLATED or EXACT."""


def contacts(
    body: PosedBody,
    scene: Scene | None,
    k: int,
    mount: float,
    search: ContactSearch,
    scratch: Scratch,
    rows: Rows,
    at: int,
) -> tuple[int, float]:
    """Write a row for every place of segment `k` that is closer than `search.margin` to an obstacle, from row `at` on.

    Between `search.margin` and `search.wish` the row is SOFT. `mount` is what is left of the mount where the segment
    begins. Returns the next free row and the least clearance that was seen at a place (infinite: none was examined
    closely). When the time of the clock in `scratch` is over, rows are missing.
    """
    if scene is None:
        return at, math.inf
    q, frames = body.q, body.frames
    start, length, radius = free_part(body.limits, q, k, mount), q[k, 2], body.limits[k, RADIUS]
    part = 1.0 - start
    least = math.inf
    among, clock = scratch.among, scratch.clock
    if part <= 0.0 or radius < 0.0 or spend(clock, scene.table.shape[0]):
        return at, least
    half = 0.5 * length * part
    needed, wished = radius + search.margin, radius + max(search.margin, search.wish)
    count, _ = few_near(scene, body_point(q, frames, k, start + 0.5 * part), wished + half, among)
    last = at + PER_SEGMENT
    units = work_among(scene, among, count)
    level, piece = 0, 0
    while count != 0 and piece < 1 << level and not spend(clock, units):
        width = part / (1 << level)
        s = start + (piece + 0.5) * width
        p = body_point(q, frames, k, s)
        halves, reach, mode = level < search.depth, wished, search.mode
        if halves:  # only whether anything is in reach matters, and samples mostly know that
            reach, mode = wished + 0.5 * length * width, LOWER_BOUND if mode == EXACT else mode
        d, most, nearest = closest(scene, among, count, p, reach, mode)
        if mode == LOWER_BOUND and d < reach <= most:
            d, _, nearest = closest(scene, among, count, p, reach, EXACT)
        if halves and d < reach:
            level, piece = level + 1, 2 * piece
            continue
        level, piece = following(level, piece)
        least = min(least, d - radius)
        if d < wished:
            listed = near(scene, p, wished, among)[0] if count == MANY else count
            for j in range(listed):
                if at < last:
                    known = d if among[j] == nearest else math.inf
                    at = _contact(body, scene, among[j], (k, s, p), (needed, wished, known), search.mode, rows, at)
    return at, least


def _contact(
    body: PosedBody, scene: Scene, i: int, place: Place, distances: Vec, mode: int, rows: Rows, at: int
) -> int:
    """Write the row of a place near obstacle `i`.

    `distances`: what is needed, what is wished for, and what is there, where that is known, else infinite.
    """
    needed, wished, known = distances
    d, g = slope_known(scene, i, place[2], wished, mode, known)
    if d >= wished:
        return at
    soft = d >= needed
    weight = (SOFTNESS if soft else 1.0) / body.unit
    value = weight * ((wished if soft else needed) - d)
    return put_body_row(rows, at, body.q, body.frames, place, scale(weight, g), SOFT if soft else INNER, value)
