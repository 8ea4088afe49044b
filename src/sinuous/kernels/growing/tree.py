"""The chains that are kept of every length: the memory of a beam search, and which chains are kept."""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.compile import kernel
from sinuous.kernels.growing.arcs import ARCS
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array, Mat, Vec
from sinuous.kernels.problem import Problem

Level = namedtuple("Level", ["frames", "q", "parent", "seen", "children", "along", "cost", "score"])
"""Chains of one number of segments, by number: poses (m, 12) of their ends; their last segment (m, 3); which chain of
the level before it continues (m,) int64; which point of the guide its end sees (m,) int64; by how many it is continued
(m,) int64; its length (m,); what its overlaps cost (m,); and its score (m,), the less the better."""

Tree = namedtuple("Tree", ["levels", "made", "arcs", "heap", "items", "buckets", "clock", "among"])
"""All that a search works in: the levels (arrays with one more axis in front); the chains that are made for the next
one; the arcs (c, 3) that are to be tried; a heap of either; the buckets (b,) int64 that tell like chains; the
clock; and the numbers (m,) int64 of obstacles."""

LAZY = 3
"""Chains that are looked at for each one that is kept."""

WIDTH = 12 + 3 + 6
"""Numbers of one chain of a level."""


def tree_size(segments: int, width: int) -> int:
    """Numbers (float64) that a search works in, that keeps `width` chains, a power of two, of every length."""
    arcs, chains = width * ARCS, width * (segments + 1 + LAZY)
    return WIDTH * chains + 5 * arcs + 4 * width + CLOCK_SIZE


@kernel
def _level(buffer: Array, levels: int, width: int) -> Level:
    """Lay out so many levels in the beginning of a buffer."""
    m = levels * width
    return Level(
        shaped(buffer[: 12 * m], (levels, width, 12)),
        shaped(buffer[12 * m : 15 * m], (levels, width, 3)),
        shaped(buffer[15 * m : 16 * m].view(np.int64), (levels, width)),
        shaped(buffer[16 * m : 17 * m].view(np.int64), (levels, width)),
        shaped(buffer[17 * m : 18 * m].view(np.int64), (levels, width)),
        shaped(buffer[18 * m : 19 * m], (levels, width)),
        shaped(buffer[19 * m : 20 * m], (levels, width)),
        shaped(buffer[20 * m : 21 * m], (levels, width)),
    )


@kernel
def carve_tree(buffer: Array, problem: Problem, width: int) -> Tree:
    """Lay out the memory of a search, see `tree_size`."""
    segments, obstacles = problem.limits.shape[0], problem.scene.table.shape[0]
    arcs, kept, made = width * ARCS, WIDTH * width * (segments + 1), width * LAZY
    rest = buffer[kept + WIDTH * made :]
    return Tree(
        _level(buffer, segments + 1, width),
        _level(buffer[kept:], 1, made),
        shaped(rest[: 3 * arcs], (arcs, 3)),
        rest[3 * arcs : 4 * arcs],
        rest[4 * arcs : 5 * arcs].view(np.int64),
        rest[5 * arcs : 5 * arcs + 4 * width].view(np.int64),
        rest[5 * arcs + 4 * width :][:CLOCK_SIZE].view(np.int64),
        rest[5 * arcs + 4 * width + CLOCK_SIZE :][:obstacles].view(np.int64),
    )


@kernel
def level_of(levels: Level, k: int) -> Level:
    """Chains of `k` segments."""
    return Level(
        levels.frames[k],
        levels.q[k],
        levels.parent[k],
        levels.seen[k],
        levels.children[k],
        levels.along[k],
        levels.cost[k],
        levels.score[k],
    )


@kernel
def empty_buckets(tree: Tree) -> None:
    """Forget which chains are alike."""
    for i in range(tree.buckets.shape[0]):
        tree.buckets[i] = 0


@kernel
def _bucket(pose: tuple[Mat, Vec], edge: float) -> int:
    """Number of the bucket of a chain: its end lies in the same cube and points into much the same direction."""
    r, p = pose
    key = 1
    for x in (p[0] / edge, p[1] / edge, p[2] / edge, 1.5 * r[0][2], 1.5 * r[1][2], 1.5 * r[2][2]):
        key = key * 1000003 + math.floor(x + 0.5)
    return key | 1


@kernel
def differs(tree: Tree, pose: tuple[Mat, Vec], edge: float) -> bool:
    """Whether no chain was kept yet that ends alike; the chain counts as kept from then on."""
    key = _bucket(pose, edge)
    mask = tree.buckets.shape[0] - 1
    at = int((np.uint64(key) * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(40)) & mask
    while tree.buckets[at] != 0:
        if tree.buckets[at] == key:
            return False
        at = (at + 1) & mask
    tree.buckets[at] = key
    return True


@kernel
def put_chain(level: Level, to: int, made: Level, i: int) -> None:
    """Keep chain `i` of those made as chain `to` of a level."""
    for j in range(12):
        level.frames[to, j] = made.frames[i, j]
    for j in range(3):
        level.q[to, j] = made.q[i, j]
    level.parent[to], level.seen[to] = made.parent[i], made.seen[i]
    level.along[to] = made.along[i]
    level.cost[to], level.score[to] = made.cost[i], made.score[i]


@kernel
def trace(levels: Level, k: int, i: int, q: Array) -> None:
    """Fill the first rows of `q` (n, 3) with chain `i` of `k` segments."""
    while k > 0:
        for j in range(3):
            q[k - 1, j] = levels.q[k, i, j]
        i = levels.parent[k, i]
        k -= 1
