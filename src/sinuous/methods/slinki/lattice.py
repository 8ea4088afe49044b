"""A tree of robot shapes that grows segment by segment, in the order of what it may cost: weighted A*.

A node is the pose of a segment's end. Its children are the poses that the next segment reaches by one of its
primitives: lengths evenly over its range, straight or bent by one of a few angles (growing with their squares) in one
of a few directions. What a node costs is the sum of its squared bends; what it may still cost is seen from the biarc
(two arcs that meet smoothly, Bolton 1975) from there to the target: its squared bends, shared among the segments that
are left, and by how much it is longer or shorter than they can be, or bends more.
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.chain.single_arc import arc_length
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array, Vec, add, add_scaled, dot, norm, sub
from sinuous.kernels.step.limits import bend_cap
from sinuous.kernels.tables import MAX_LENGTH, MIN_LENGTH
from sinuous.methods.fabrik.links import angle_between, unit_or
from sinuous.methods.search import cut

Tree = namedtuple("Tree", ["frames", "q", "effort", "travel", "parent", "depth", "priority", "open"])
"""Nodes: frame (12,) of the end, the segment (3,) that leads there, cost so far, length so far, parent, number of
segments; and the heap of those that are open: what they cost in all, and their numbers."""

PER_NODE = 12 + 3 + 6
"""Numbers (float64) that a node takes from a buffer."""

WIDEST = 0.5 * math.pi
"""Most that a primitive bends."""

MISFIT = 10.0
"""Cost of a length that is off by the mean length of what is left, squared: as much as so many rad, squared."""

IMPOSSIBLE = 1e6
"""Cost of a length that is off by far more than that."""

WIDEST_HALF = 3.1
"""Half the bend from which on there is no single arc, in rad."""


@kernel
def carve_tree(buffer: Array, nodes: int) -> Tree:
    """Lay out a tree in the beginning of `buffer` (`PER_NODE` numbers a node)."""
    frames, rest = cut(buffer, nodes, 12)
    q, rest = cut(rest, nodes, 3)
    effort, travel, priority = rest[:nodes], rest[nodes : 2 * nodes], rest[2 * nodes : 3 * nodes]
    whole = rest[3 * nodes : 6 * nodes].view(np.int64)
    return Tree(
        frames, q, effort, travel, whole[:nodes], whole[nodes : 2 * nodes], priority, whole[2 * nodes : 3 * nodes]
    )


@kernel
def biarc(begin: Vec, first: Vec, end: Vec, last: Vec) -> tuple[float, float, float, float]:
    """Bends and lengths of the two arcs with links of equal length from `begin`, tangent `first`, to `end`, `last`.

    The joints `begin + d first` and `end - d last` are `2 d` apart: a quadratic equation with one positive root.
    Infinite lengths where there is none.
    """
    across, sum_of = sub(end, begin), add(first, last)
    along, square = dot(across, sum_of), dot(across, across)
    curve = 2.0 * (dot(first, last) - 1.0)
    below = along + math.sqrt(max(0.0, along * along - curve * square))
    if below <= 1e-9 * math.sqrt(square):
        return 0.0, 0.0, math.inf, math.inf
    d = square / below
    middle = unit_or(add_scaled(across, -d, sum_of), first)
    bend_1, bend_2 = angle_between(first, middle), angle_between(middle, last)
    return bend_1, bend_2, d * stretch_of(bend_1), d * stretch_of(bend_2)


@kernel
def stretch_of(bend: float) -> float:
    """Length of an arc whose two links have length one."""
    return 2.0 if bend < 1e-6 else bend / math.tan(0.5 * bend)


@kernel
def single(begin: Vec, first: Vec, end: Vec) -> tuple[float, float]:
    """Bend (rad) and length of the arc from `begin`, tangent `first`, to `end`; infinite where that is behind."""
    across = sub(end, begin)
    half = angle_between(first, unit_or(across, first))
    return 2.0 * half, arc_length(norm(across), half) if half < WIDEST_HALF else math.inf


@kernel
def _beyond(value: float, low: float, high: float, unit: float) -> float:
    """By how much a length is outside its range, squared, in units."""
    off = max(0.0, low - value, value - high)
    return (off / unit) ** 2 if off < 1e3 * unit else IMPOSSIBLE


@kernel
def outlook(limits: Array, sums: Array, k: int, begin: Vec, first: Vec, end: Vec, last: Vec, aimed: bool) -> float:
    """What the segments from number k on may cost to get from `begin`, tangent `first`, to `end`.

    `limits` (n, 7); `sums` (n + 1, 3): of segments k and after, the least and greatest length and the largest bend.
    """
    left = sums.shape[0] - 1 - k
    unit = max(0.5 * (sums[k, 0] + sums[k, 1]) / left, 1e-300)
    if not aimed:
        bend, length = single(begin, first, end)
        over = max(0.0, bend - sums[k, 2])
        return bend * bend / left + over * over + MISFIT * _beyond(length, sums[k, 0], sums[k, 1], unit)
    bend_1, bend_2, length_1, length_2 = biarc(begin, first, end, last)
    cost = 2.0 * (bend_1 * bend_1 + bend_2 * bend_2) / left
    if left == 2:
        over_1 = max(0.0, bend_1 - bend_cap(limits, k, limits[k, MAX_LENGTH]))
        over_2 = max(0.0, bend_2 - bend_cap(limits, k + 1, limits[k + 1, MAX_LENGTH]))
        off_1 = _beyond(length_1, limits[k, MIN_LENGTH], limits[k, MAX_LENGTH], unit)
        off_2 = _beyond(length_2, limits[k + 1, MIN_LENGTH], limits[k + 1, MAX_LENGTH], unit)
        return cost + over_1 * over_1 + over_2 * over_2 + MISFIT * (off_1 + off_2)
    over = max(0.0, bend_1 + bend_2 - sums[k, 2])
    return cost + over * over + MISFIT * _beyond(length_1 + length_2, sums[k, 0], sums[k, 1], unit)


@kernel
def primitive(limits: Array, k: int, number: int, bends: int, directions: int, lengths: int) -> tuple[Vec, bool]:
    """Primitive number `number` of segment k, with these `limits` (n, 7), and whether there is one.

    Numbers run through directions first, then bends, then lengths; every second ring of directions is turned by half a
    step.
    """
    low, high = limits[k, MIN_LENGTH], limits[k, MAX_LENGTH]
    rings = bends if bend_cap(limits, k, high) > 0.0 else 0
    around = 1 + rings * directions
    sizes = lengths if high > low else 1
    which, place = number // around, number % around
    if which >= sizes:
        return (0.0, 0.0, 0.0), False
    length = low + (high - low) * (which / (sizes - 1) if sizes > 1 else 0.5)
    if place == 0:
        return (0.0, 0.0, length), True
    ring, step = (place - 1) // directions + 1, (place - 1) % directions
    bend = (ring / rings) ** 2 * min(WIDEST, bend_cap(limits, k, length))
    angle = 2.0 * math.pi * (step + 0.5 * (ring & 1)) / directions
    return (bend * math.cos(angle), bend * math.sin(angle), length), True
