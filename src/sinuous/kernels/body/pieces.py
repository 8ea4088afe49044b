"""Pieces of segments, and the obstacles that may be near them: what contacts and the proof have in common."""

import math
from collections import namedtuple

from sinuous.kernels.compile import inline
from sinuous.kernels.fields.distances import Scene, evaluate, work_of
from sinuous.kernels.fields.solids import INTERPOLATED, LOWER_BOUND
from sinuous.kernels.maths.vectors import Array, Vec
from sinuous.kernels.tables import KIND, RIGID, ROUNDOFF, TREE

Scratch = namedtuple("Scratch", ["among", "clock"])
"""What examining obstacles works on: their numbers (m,) int64, and the clock, see `kernels.clock`."""

evaluate_here = inline(evaluate)


def backbone_of(limits: Array, q: Array, k: int) -> float:
    """Length of the backbone in row `k`: joints and links have none."""
    return float(q[k, 2]) if limits[k, RIGID] == 0.0 else 0.0


def free_part(limits: Array, q: Array, k: int, mount: float) -> float:
    """Fraction of segment `k` that lies within the mount; `mount` is what is left of it where the segment begins."""
    if mount <= 0.0 or limits[k, RIGID] != 0.0:
        return 0.0
    if mount >= q[k, 2]:
        return 1.0
    return mount / q[k, 2]


def near(scene: Scene, p: Vec, reach: float, among: Array) -> tuple[int, float]:
    """List in `among` the obstacles that may be closer to `p` than `reach`: their number, and a bound of the others.

    No upper bound is asked for, so INTERPOLATED serves for primitives: most are far, and balls about them say so.
    """
    count, rest = 0, math.inf
    for i in range(scene.table.shape[0]):
        roundoff, mode = scene.table[i, ROUNDOFF], LOWER_BOUND if scene.table[i, KIND] >= TREE else INTERPOLATED
        d = evaluate_here(scene, i, p, reach + roundoff, mode)[0] - roundoff
        if d < reach:
            among[count] = i
            count += 1
        elif d < rest:
            rest = d
    return count, rest


def work_among(scene: Scene, among: Array, count: int) -> int:
    """Work units that the distance to the first `count` obstacles costs that `among` lists."""
    units = 0
    for j in range(count):
        units += work_of(scene, among[j])
    return units


def following(level: int, piece: int) -> tuple[int, int]:
    """Piece that comes after this one, as large as its place allows; (0, 1) when there is none.

    Piece number `piece` of level `level` is one of `2 ** level` equal parts of the segment.
    """
    piece += 1
    while level > 0 and piece & 1 == 0:
        level, piece = level - 1, piece >> 1
    return level, piece


def closest(scene: Scene, among: Array, count: int, p: Vec, reach: float, mode: int) -> tuple[float, float, int]:
    """Least distance of `p` to the first `count` obstacles that `among` lists, an upper bound of it, and the obstacle.

    The distance is less by what arithmetic may make of it for the size of the obstacle's coordinates.

    `mode` of the query, and `reach`, beyond which a distance does not matter: see `distances.evaluate`. `among` (m,)
    int64.
    """
    least, most, which = math.inf, math.inf, -1
    for j in range(count):
        roundoff = scene.table[among[j], ROUNDOFF]
        d, upper = evaluate_here(scene, among[j], p, min(reach, least) + roundoff, mode)
        d, most = d - roundoff, min(most, upper)
        if d < least:
            least, which = d, among[j]
    return least, most, which
