"""Pieces of segments, and the obstacles that may be near them: what contacts and the proof have in common.

`among` (m,) int64 holds numbers of obstacles.
"""

import math
from collections import namedtuple

from sinuous.kernels.compile import inline, shared
from sinuous.kernels.fields.distances import Scene, evaluate, is_large, search, work_of, work_of_all
from sinuous.kernels.fields.hierarchy import (
    ENTRY_SIZE,
    LEAST_SQUARE,
    LIST_BEYOND,
    LIST_COUNT,
    LIST_SIZE,
    cell_of,
    item_of,
    nearer_leaf,
    tree_over,
)
from sinuous.kernels.fields.solids import INTERPOLATED, LOWER_BOUND
from sinuous.kernels.maths.vectors import Array, Vec
from sinuous.kernels.tables import HIERARCHY_HEADER, HIERARCHY_ROUNDOFF, HIERARCHY_SPACING, KIND, RIGID, ROUNDOFF, TREE

MANY = -1
"""A number of obstacles: too many to be listed, or asked one after the other. The hierarchy is asked again."""

FEW, MOST_SORTED = 12, 256
"""Most obstacles of a large scene that are listed where the hierarchy may be asked again, and where it may not: of more
than these everyone is asked."""

SURELY, SAMPLED = 1e-6, 8.0
"""What an obstacle that a cell lists may be farther than it says, as a share of the reach, and in what arithmetic and
samples may be wrong by."""

BEYOND = 1.0 + 1e-6
"""By how much farther a large scene is searched than matters: what is found to be beyond is so without rounding."""

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
    if is_large(scene) and reach < math.inf:
        count = _list_near(scene, p, reach, among, MOST_SORTED)
        if count != MANY:
            return count, reach
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


def _surely_more(store: Array, cell: int, off: float, reach: float, most: int) -> bool:
    """Whether more than `most` of those that a cell lists are closer than `reach` to a point, `off` from its middle."""
    wrong = SURELY * reach + SAMPLED * (store[HIERARCHY_ROUNDOFF] + store[HIERARCHY_SPACING])
    listed = store[cell + LIST_COUNT] > most
    return bool(listed and store[cell + LIST_SIZE + ENTRY_SIZE * most + 1] + off + wrong < reach)


def _place_for(among: Array, count: int, i: int) -> int:
    """Place of a number among others in their order; -1: it is one of them."""
    e = count
    while e > 0 and among[e - 1] > i:
        e -= 1
    return -1 if e > 0 and among[e - 1] == i else e


@shared
def _list_near(scene: Scene, p: Vec, reach: float, among: Array, most: int) -> int:
    """The same in a large scene; MANY where they are more than `most`."""
    store, tree = scene.store, tree_over(scene.store)
    count, beside, besides = 0, 0, tree.items - HIERARCHY_HEADER
    square = max(reach * reach, LEAST_SQUARE) if reach > 0.0 else LEAST_SQUARE
    node, due = 0, 1
    cell, off = cell_of(store, p)
    if cell > 0 and reach > store[cell + LIST_BEYOND] - off:
        if _surely_more(store, cell, off, reach, most):
            return MANY
        cell = 0
    entry = cell + LIST_SIZE
    end = entry + ENTRY_SIZE * int(store[cell + LIST_COUNT]) if cell > 0 else 0
    while True:
        if beside < besides:
            at = HIERARCHY_HEADER + beside
            beside += 1
        elif cell > 0:
            if entry == end or store[entry + 1] - off >= reach:
                return count
            at = entry
            entry += ENTRY_SIZE
        else:
            node, due = nearer_leaf(store, tree, node, due, p, square)
            if node == 0:
                return count
            at = item_of(tree, node)
        i = int(store[at])
        e = _place_for(among, count, i)
        roundoff, mode = scene.table[i, ROUNDOFF], LOWER_BOUND if scene.table[i, KIND] >= TREE else INTERPOLATED
        if e < 0 or evaluate(scene, i, p, reach + roundoff, mode)[0] - roundoff >= reach:
            continue
        if count == most:
            return MANY
        for j in range(count, e, -1):
            among[j] = among[j - 1]
        among[e] = i
        count += 1


def few_near(scene: Scene, p: Vec, reach: float, among: Array) -> tuple[int, float]:
    """The same as `near`, but of a large scene nothing is listed where it would be more than a `FEW`: that is MANY."""
    if is_large(scene):
        count = MANY if reach == math.inf else _list_near(scene, p, reach, among, FEW)
        return count, math.inf if count == MANY else reach
    return near(scene, p, reach, among)


def work_among(scene: Scene, among: Array, count: int) -> int:
    """Work units that the distance to the first `count` obstacles costs that `among` lists."""
    if count == MANY:
        return work_of_all(scene)
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
    if count == MANY:
        return search(scene, p, BEYOND * reach, mode, -1.0, -1)
    least, most, which = math.inf, math.inf, -1
    for j in range(count):
        roundoff = scene.table[among[j], ROUNDOFF]
        d, upper = evaluate_here(scene, among[j], p, min(reach, least) + roundoff, mode)
        d, most = d - roundoff, min(most, upper)
        if d < least:
            least, which = d, among[j]
    return least, most, which
