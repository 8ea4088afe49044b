"""A tree of boxes over many triangles, balls or cubes: which of them is the closest to a point.

The tree is complete: node 1 is the root, node i has the children 2i and 2i + 1, and the leaves are its last level. So
it needs no links, and the walk through it no stack: what is still to be visited is one bit a level. Leaf j of 2^levels
has the items from `(j * count) >> levels` on.

Signed distances are compared as *lifted*: their squares where they are positive, themselves where not. That keeps their
order and saves most of the roots.

`order` (count,) int64 holds numbers of items, `centers` (count, 3), `lows` (count, 3) and `highs` (count, 3) are the
middles and corners of their boxes.
"""

import math
from collections import namedtuple

from sinuous.kernels import tables as t
from sinuous.kernels.compile import entry, inline
from sinuous.kernels.fields import triangles
from sinuous.kernels.fields.primitives import FLAT, Patch, box, lean, patch_size
from sinuous.kernels.fields.triangles import read
from sinuous.kernels.maths.vectors import Array, Vec, dot, norm, scale, sub

Tree = namedtuple("Tree", ["nodes", "levels", "items", "count", "kind", "half"])
"""Where nodes and items begin in the store; number of levels and items; kind of these; half side of cubes."""


def tree_of(table: Array, i: int) -> Tree:
    """Tree of obstacle `i`."""
    return Tree(
        int(table[i, t.NODES]),
        int(table[i, t.LEVELS]),
        int(table[i, t.ITEMS]),
        int(table[i, t.ITEM_COUNT]),
        int(table[i, t.ITEM_KIND]),
        table[i, t.CUBE_HALF],
    )


def lift(d: float) -> float:
    return d * d if d > 0.0 else d


def unlift(d: float) -> float:
    return math.sqrt(d) if d > 0.0 else d


def _lifted(x: float, y: float, z: float) -> float:
    """Lifted distance to a box of a point that is so far beyond its nearer face along each axis (negative: inside)."""
    most = max(x, y, z)
    if most <= 0.0:
        return most
    x, y, z = max(x, 0.0), max(y, 0.0), max(z, 0.0)
    return x * x + y * y + z * z


def box_distance(store: Array, at: int, p: Vec) -> float:
    """Lifted distance of `p` to the box at `at`."""
    return _lifted(
        max(store[at] - p[0], p[0] - store[at + 3]),
        max(store[at + 1] - p[1], p[1] - store[at + 4]),
        max(store[at + 2] - p[2], p[2] - store[at + 5]),
    )


def cube_distance(local: Vec, half: float) -> float:
    """Lifted distance to a cube about the origin."""
    return _lifted(abs(local[0]) - half, abs(local[1]) - half, abs(local[2]) - half)


def item_distance(store: Array, tree: Tree, i: int, p: Vec, best: float) -> float:
    """Lifted distance to item `i`; at least `best` where it is not less than that."""
    if tree.kind == t.TRIANGLES:
        return triangles.square_distance(store, tree.items + t.TRIANGLE_SIZE * i, p, best)
    if tree.kind == t.CUBES:
        return cube_distance(sub(p, read(store, tree.items + 3 * i)), tree.half)
    at = tree.items + 4 * i
    away, radius = sub(p, read(store, at)), store[at + 3]
    square = dot(away, away)
    reach = unlift(best) + radius
    if reach <= 0.0 or square >= reach * reach:
        return best
    return lift(math.sqrt(square) - radius)


def next_leaf(store: Array, tree: Tree, node: int, due: int, p: Vec, best: float) -> tuple[int, int]:
    """Go down from a node, or on from node 0, to the next leaf whose box is closer to `p` than `best` (lifted).

    Returns it, or 0 where there is none; and a bit for every level of it: whether the sibling is still to be visited.
    The root's bit is 1. From a leaf it goes on to the next.
    """
    first_leaf = 1 << tree.levels
    descend = node == 0 and box_distance(store, tree.nodes + t.NODE_SIZE, p) < best
    if node == 0:
        node = due = 1
    while True:
        while not descend:
            while due & 1 == 0:
                due >>= 1
                node >>= 1
            if due == 1:
                return 0, due
            due ^= 1
            node ^= 1
            descend = box_distance(store, tree.nodes + t.NODE_SIZE * node, p) < best
        if node >= first_leaf:
            return node, due
        left = box_distance(store, tree.nodes + 2 * t.NODE_SIZE * node, p)
        right = box_distance(store, tree.nodes + 2 * t.NODE_SIZE * node + t.NODE_SIZE, p)
        descend = min(left, right) < best
        if descend:
            node = 2 * node + (1 if right < left else 0)
            due = 2 * due + (1 if max(left, right) < best else 0)


next_leaf_here = inline(next_leaf)


def closest(store: Array, tree: Tree, p: Vec, best: float) -> tuple[int, float]:
    """Find the item closest to `p`, if it is closer than `best` (lifted): its number or -1, and how far it is."""
    found, node, due = -1, 0, 1
    while True:
        node, due = next_leaf_here(store, tree, node, due, p, best)
        if node == 0:
            return found, best
        leaf = node - (1 << tree.levels)
        for i in range((leaf * tree.count) >> tree.levels, ((leaf + 1) * tree.count) >> tree.levels):
            d = item_distance(store, tree, i, p, best)
            if d < best:
                found, best = i, d


def item_slope(store: Array, tree: Tree, i: int, p: Vec, normals: int) -> tuple[float, Vec]:
    """Distance of `p` to item `i`, and its gradient; of a triangle signed where `normals` begin in the store."""
    if tree.kind == t.TRIANGLES:
        return triangles.signed(store, tree.items + t.TRIANGLE_SIZE * i, normals, i, p)
    if tree.kind == t.CUBES:
        return box(sub(p, read(store, tree.items + 3 * i)), (tree.half, tree.half, tree.half))
    at = tree.items + 4 * i
    away = sub(p, read(store, at))
    far = norm(away)
    return far - store[at + 3], (scale(1.0 / far, away) if far > 0.0 else (0.0, 0.0, 1.0))


def item_beside(store: Array, tree: Tree, i: int, patch: Patch, size: float) -> tuple[float, Vec]:
    """Lower bound of the distance of a patch to item `i`, by the tangent at its center, and the gradient there."""
    d, g = item_slope(store, tree, i, patch.center, -1)
    return d + (lean(g, patch) if size < FLAT * d else -size), g


def bound_patch(store: Array, tree: Tree, patch: Patch, best: float) -> tuple[float, Vec]:
    """Lower bound of the distance of a patch to all items, if it is less than `best`, else that.

    Also the gradient, at the center, of the distance to the item that decides.
    """
    size, g = patch_size(patch), (0.0, 0.0, 1.0)
    node, due = 0, 1
    while True:
        node, due = next_leaf_here(store, tree, node, due, patch.center, lift(best + size))
        if node == 0:
            return best, g
        leaf = node - (1 << tree.levels)
        for i in range((leaf * tree.count) >> tree.levels, ((leaf + 1) * tree.count) >> tree.levels):
            low, own = item_beside(store, tree, i, patch, size)
            if low < best:
                best, g = low, own


def _select(order: Array, centers: Array, axis: int, first: int, last: int, middle: int) -> None:
    """Put in place `middle` of order[first:last] what belongs there, no greater before it, no less after it (Hoare)."""
    low, high = first, last - 1
    while low < high:
        pivot = centers[order[(low + high) >> 1], axis]
        i, j = low, high
        while i <= j:
            while centers[order[i], axis] < pivot:
                i += 1
            while centers[order[j], axis] > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if middle <= j:
            high = j
        elif middle >= i:
            low = i
        else:
            return


def _longest_axis(order: Array, centers: Array, first: int, last: int) -> int:
    longest, extent = 0, -1.0
    for axis in range(3):
        low = high = centers[order[first], axis]
        for i in range(first + 1, last):
            x = centers[order[i], axis]
            low, high = min(low, x), max(high, x)
        if high - low > extent:
            longest, extent = axis, high - low
    return longest


@entry
def arrange(centers: Array, levels: int, order: Array) -> None:
    """Order the items with these centers (count, 3) for a tree of `levels`: halved along the longest axis.

    `order` holds 0 .. count - 1, in any order.
    """
    count = order.shape[0]
    for level in range(levels):
        for j in range(1 << level):
            first, last = (j * count) >> level, ((j + 1) * count) >> level
            if last - first > 1:
                middle = ((2 * j + 1) * count) >> (level + 1)
                _select(order, centers, _longest_axis(order, centers, first, last), first, last, middle)


@entry
def enclose(lows: Array, highs: Array, order: Array, levels: int, nodes: Array) -> None:
    """Fill `nodes` (2 << levels, 6) with boxes about the items between the corners `lows` and `highs`."""
    count = order.shape[0]
    for node in range((2 << levels) - 1, 0, -1):
        for axis in range(3):
            nodes[node, axis], nodes[node, axis + 3] = math.inf, -math.inf
        if node >= 1 << levels:
            leaf = node - (1 << levels)
            for i in range((leaf * count) >> levels, ((leaf + 1) * count) >> levels):
                for axis in range(3):
                    nodes[node, axis] = min(nodes[node, axis], lows[order[i], axis])
                    nodes[node, axis + 3] = max(nodes[node, axis + 3], highs[order[i], axis])
        else:
            for child in range(2 * node, 2 * node + 2):
                for axis in range(3):
                    nodes[node, axis] = min(nodes[node, axis], nodes[child, axis])
                    nodes[node, axis + 3] = max(nodes[node, axis + 3], nodes[child, axis + 3])
    for axis in range(t.NODE_SIZE):
        nodes[0, axis] = 0.0
