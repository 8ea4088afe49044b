"""Two trees of configurations that grow towards each other: RRT-Connect (Kuffner & LaValle 2000).

One grows from the start, the other from the goals. A random configuration is drawn; one tree grows from its nearest
node towards it, and the other towards what was reached, as far as it can. At first edges are only examined, for most
of them are on no path (Sanchez & Latombe 2001); whoever proves the path cuts off what is not clear. Then every edge is
proved clear as far as it goes.

`levers` (n,) are squares of levers, see `space`; `begin` (n, 3) is a configuration.
"""

import math
from collections import namedtuple

from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.chain.kinematics import interpolate
from sinuous.kernels.clock import SEGMENT_WORK, late, spend
from sinuous.kernels.maths.vectors import Array, copy, get_vec, put_vec
from sinuous.kernels.planning.space import Space, distance, draw, probe_edge, prove_edge, random, squared_distance
from sinuous.kernels.step.actuation import admissible_step

Trees = namedtuple("Trees", ["q", "parents", "counts", "drawn"])
"""Nodes of both trees (2, c, n, 3), their parents (2, c) int64 (-1: a root; `GONE`: it was taken out), how many there
are (2,) int64; and the configuration that was drawn (n, 3)."""

GrowthTerms = namedtuple("GrowthTerms", ["step", "spacing", "least", "finest", "back", "seed", "proves"])
"""Longest edge; how far nodes along an edge are from each other; the shortest edge; the length below which a proof is
not halved; how far an edge stays back from what stops it, all in the length unit; the seed; and whether edges are
proved, or only examined."""

COARSE_DRAW, FINER_DRAW, FINEST_DRAW = 1.0, 0.1, 0.01
"""How fine the shortest edge, proofs and what stays back are, as shares: most are coarse, every fourth is finer, every
sixteenth the finest. Who stands close to an obstacle needs small steps, others are quicker without."""

BEHIND = 3
"""So many times as many nodes must one tree have for the other to have three of four draws: that one begins in a narrow
place."""

GONE = -2
"""The parent of a node that was taken out."""

ALONE = 0.75
"""Share of its draws in which only a run of segments moves. Of all directions at once hardly any leads out of there."""


def plant(trees: Trees, side: int, q: Array) -> None:
    """Make a configuration (n, 3) a root of a tree."""
    copy(q, trees.q[side, trees.counts[side]])
    trees.parents[side, trees.counts[side]] = -1
    trees.counts[side] += 1


def _find_nearest(trees: Trees, side: int, q: Array, levers: Array) -> int:
    """The node of a tree that is nearest to a configuration."""
    least, at = math.inf, 0
    for i in range(trees.counts[side]):
        apart = squared_distance(trees.q[side, i], q, levers, least)
        if apart < least:
            least, at = apart, i
    return at


def _extend(space: Space, trees: Trees, side: int, at: int, goal: Array, terms: GrowthTerms) -> tuple[int, bool]:
    """Let a tree grow from node `at` towards `goal` (n, 3) by one edge, as far as that is clear.

    Returns the last new node (-1: there is none), and whether that is the goal.
    """
    new, begin = trees.counts[side], trees.q[side, at]
    far = distance(begin, goal, space.levers)
    part = min(1.0, terms.step / far) if far > 0.0 else 1.0
    interpolate(begin, goal, part, trees.q[side, new])
    if far > 0.0:
        whole = part * far
        part *= probe_edge(space, begin, trees.q[side, new], terms.back / whole, terms.least / whole, terms.back)
        if part * far < terms.least:
            return -1, False
        interpolate(begin, goal, part, trees.q[side, new])
    clear, until = True, 1.0
    if terms.proves:
        verdict, until = prove_edge(space, begin, trees.q[side, new], terms.finest, True)
        clear = verdict == CLEAR
    if not clear:
        part = part * until - terms.back / far if far > 0.0 else 0.0
        if part * far < terms.least:
            return -1, False
    count = min(max(1, math.ceil(part * far / terms.spacing)), trees.q.shape[1] - new)
    for i in range(count):
        interpolate(begin, goal, part * (i + 1) / count, trees.q[side, new + i])
        trees.parents[side, new + i] = at if i == 0 else new + i - 1
    trees.counts[side] = new + count
    return new + count - 1, clear and part >= 1.0


def _connect(space: Space, trees: Trees, side: int, goal: Array, terms: GrowthTerms) -> int:
    """Let a tree grow towards `goal` (n, 3) until it is there, and return that node; -1 where it is stopped."""
    at = _find_nearest(trees, side, goal, space.levers)
    while trees.counts[side] < trees.q.shape[1]:
        at, there = _extend(space, trees, side, at, goal, terms)
        if at < 0 or there:
            return at
        if distance(trees.q[side, at], goal, space.levers) < terms.least or late(space.sweep.clock):
            return -1
    return -1


def _find_smaller_tree(trees: Trees) -> int:
    """The tree that has far fewer nodes than the other; -1: none has."""
    if BEHIND * trees.counts[0] < trees.counts[1]:
        return 0
    return 1 if BEHIND * trees.counts[1] < trees.counts[0] else -1


def _keep_others(space: Space, begin: Array, index: int, seed: int, drawn: Array) -> None:
    """Let only a random run of segments differ between what was drawn (n, 3) and where it is gone to from."""
    n = begin.shape[0]
    one, other = int(n * random(index, seed + 1, 0)), int(n * random(index, seed + 1, 1))
    for k in range(n):
        if k < min(one, other) or k > max(one, other):
            put_vec(drawn, k, 0, get_vec(begin, k, 0))
    interpolate(begin, drawn, admissible_step(space.robot.actuation, begin, drawn), drawn)


def grow(space: Space, trees: Trees, terms: GrowthTerms, first: int, last: int) -> tuple[int, int, int]:
    """Let both trees grow by draws `first` to `last` - 1, until they meet.

    Returns the nodes, one a tree, where they do (-1, -1: they do not), and the draw to go on with.
    """
    most = trees.q.shape[1] - 1
    for index in range(first, last):
        if max(trees.counts[0], trees.counts[1]) >= most:
            return -1, -1, last
        if spend(space.sweep.clock, trees.counts[0] + trees.counts[1] + SEGMENT_WORK):
            return -1, -1, last
        draw(space, trees.q[0, 0], index, terms.seed, trees.drawn)
        fine = COARSE_DRAW if index % 4 != 3 else FINER_DRAW if index % 16 != 15 else FINEST_DRAW
        own = _refine_terms(terms, fine)
        side, behind = index % 2 if fine == COARSE_DRAW else index // 4 % 2, _find_smaller_tree(trees)
        if behind >= 0:
            side = behind if index % 4 > 0 else 1 - behind
        at = _find_nearest(trees, side, trees.drawn, space.levers)
        if side == behind and random(index, terms.seed + 2, 0) < ALONE:
            _keep_others(space, trees.q[side, at], index, terms.seed, trees.drawn)
        new, _ = _extend(space, trees, side, at, trees.drawn, own)
        if new >= 0:
            met = _connect(space, trees, 1 - side, trees.q[side, new], own)
            if met >= 0:
                return (new, met, index + 1) if side == 0 else (met, new, index + 1)
    return -1, -1, last


def _refine_terms(terms: GrowthTerms, fine: float) -> GrowthTerms:
    """The same terms for a draw that is so fine."""
    return GrowthTerms(
        terms.step, terms.spacing, terms.least * fine, terms.finest * fine, terms.back * fine, terms.seed, terms.proves
    )


def cut_off(trees: Trees, first: int, second: int, edge: int) -> None:
    """Take out of a tree what hangs on one edge of the path that `path_through` found, 0 = the first one."""
    before, at = 0, first
    while trees.parents[0, at] >= 0:
        before, at = before + 1, trees.parents[0, at]
    side = 0 if edge < before else 1
    at, steps = (first, before - 1 - edge) if side == 0 else (second, edge - before)
    for _ in range(steps):
        at = trees.parents[side, at]
    _take_out_from(trees, side, at)


def _take_out(trees: Trees, side: int, i: int) -> None:
    """Take a node out of a tree: it stays where it is, and is near to nothing."""
    trees.parents[side, i] = GONE
    trees.q[side, i] = math.inf


def _take_out_from(trees: Trees, side: int, root: int) -> None:
    """Take a node out of a tree, and all that grows from it."""
    _take_out(trees, side, root)
    for i in range(root + 1, trees.counts[side]):  # a node comes after its parent
        if _has_lost_parent(trees, side, i):
            _take_out(trees, side, i)


def _has_lost_parent(trees: Trees, side: int, i: int) -> bool:
    above = trees.parents[side, i]
    return bool(above >= 0 and trees.parents[side, above] == GONE)


def prove_trees(space: Space, trees: Trees, finest: float) -> None:
    """Prove all edges, and take out of the trees what hangs on one that is not proved clear."""
    for side in range(2):
        for i in range(trees.counts[side]):
            above = trees.parents[side, i]
            if above < 0:
                continue
            q = trees.q[side]
            if _has_lost_parent(trees, side, i) or prove_edge(space, q[above], q[i], finest, False)[0] != CLEAR:
                _take_out(trees, side, i)


def path_through(trees: Trees, first: int, second: int, path: Array) -> int:
    """Fill `path` (p, n, 3) with the nodes from the start to a goal, through a pair where the trees meet.

    Returns how many they are; 0 where they do not fit.
    """
    count, at = 0, first
    while at >= 0:
        count, at = count + 1, trees.parents[0, at]
    before, at = count, trees.parents[1, second]
    while at >= 0:
        count, at = count + 1, trees.parents[1, at]
    if count > path.shape[0]:
        return 0
    i, at = before - 1, first
    while at >= 0:
        copy(trees.q[0, at], path[i])
        i, at = i - 1, trees.parents[0, at]
    i, at = before, trees.parents[1, second]
    while at >= 0:
        copy(trees.q[1, at], path[i])
        i, at = i + 1, trees.parents[1, at]
    return count
