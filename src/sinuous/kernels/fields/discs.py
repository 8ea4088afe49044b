"""Discs about the nodes of a tree of triangles, which say better than boxes how far a point is at least.

A smooth surface is nearly flat in a small place, but seldom along the axes: there a box is as thick as it is wide,
while a disc across the mean normal is thin. From far away a surface is nearly as far in many places, and few of the
discs have to be opened. They are made for sampling alone, because they take more memory than the boxes.
"""

import math

from sinuous.kernels.fields.trees import Tree
from sinuous.kernels.fields.triangles import read
from sinuous.kernels.maths.vectors import Array, Vec, add, add_scaled, dot, norm, put_vec, scale, sub
from sinuous.kernels.tables import NODE_SIZE, TRIANGLE_NORMAL, TRIANGLE_SIZE

DISC_CENTER, DISC_AXIS, DISC_RADIUS, DISC_HALF = 0, 3, 6, 7
"""Columns of a disc: its centre (3), its unit normal (3), its radius, and half its thickness."""

DISC_SIZE = 8


def _axis(store: Array, tree: Tree, first: int, last: int) -> Vec:
    """Mean normal of the triangles `first` up to, without it, `last`: a unit vector."""
    total = (0.0, 0.0, 0.0)
    for i in range(first, last):
        total = add(total, read(store, tree.items + TRIANGLE_SIZE * i + TRIANGLE_NORMAL))
    size = norm(total)
    return scale(1.0 / size, total) if size > 0.0 else (0.0, 0.0, 1.0)


def enclose(store: Array, tree: Tree, discs: Array) -> None:
    """Fill `discs` (2 << levels, 8) with one for every node of a tree in the store (s,), lengths in the length unit."""
    for node in range(1, 2 << tree.levels):
        level = 0
        while node >> (level + 1) > 0:
            level += 1
        j = node - (1 << level)
        first, last = (j * tree.count) >> level, ((j + 1) * tree.count) >> level
        axis = _axis(store, tree, first, last)
        box = tree.nodes + NODE_SIZE * node
        center = scale(0.5, add(read(store, box), read(store, box + 3)))
        low, high, wide = math.inf, -math.inf, 0.0
        for i in range(first, last):
            for corner in range(3):
                away = sub(read(store, tree.items + TRIANGLE_SIZE * i + 3 * corner), center)
                height = dot(away, axis)
                low, high = min(low, height), max(high, height)
                wide = max(wide, norm(add_scaled(away, -height, axis)))
        center = add_scaled(center, 0.5 * (low + high), axis)
        # What arithmetic may be wrong by is taken off here, once for all points.
        slack = 1e-12 * (norm(center) + wide + high - low)
        discs[node, DISC_RADIUS], discs[node, DISC_HALF] = wide + slack, 0.5 * (high - low) + slack
        put_vec(discs, node, DISC_CENTER, center)
        put_vec(discs, node, DISC_AXIS, axis)
