"""The chains that are kept of every number of segments: the memory of a beam search, and which chains are kept.

A chain is a row of a table (w, `CHAIN_WIDTH`); tables of all numbers of segments are one array (n + 1, w, CHAIN_WIDTH).
Its columns: pose of its end (12); bends and length of its last segment (3), and of the one before it (3), which may
differ from those of the chain that it continues; the row of that chain; its length; what its overlaps cost; its score,
the less the better; the point of the guide that its end sees; by how many chains it is continued; and how far its end
is from the obstacles, in radii, where that is asked.

`levels` (n + 1, w, CHAIN_WIDTH), `level` (w, CHAIN_WIDTH) and `chains` (m, CHAIN_WIDTH) are such tables.
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.growing.arcs import ARCS
from sinuous.kernels.growing.bending import Nearby
from sinuous.kernels.maths import heap
from sinuous.kernels.maths.buffers import cut, cut_whole
from sinuous.kernels.maths.vectors import Array, Mat, Vec

FRAME, LAST_SEGMENT_Q, SEGMENT_BEFORE_Q, PARENT, CHAIN_LENGTH, COST, SCORE, GUIDE_POINT, CHILDREN, END_DISTANCE = (
    0,
    12,
    15,
    18,
    19,
    20,
    21,
    22,
    23,
    24,
)
CHAIN_WIDTH = 25
"""Columns of a chain, and how many numbers it has."""

LAZY = 2
"""Chains that are made for each one that is kept."""

FAN = 8
"""A chain is continued by at most 1 + width / FAN of those that are kept at first."""

END_SPACING, TANGENT_CELLS = 0.5, 1.5
"""Grid of ends of which each cell keeps one chain at first: edge in lengths of a segment, and cells for a unit of the
tangent."""

FINE_SPACING, FINE_TANGENT_CELLS = 0.1, 8.0
"""The same for the chains that are made at all."""

Beam = namedtuple("Beam", ["levels", "made", "arcs", "heap", "items", "buckets", "clock", "nearby"])
"""All that a search works in: the chains of every number of segments; those (m, CHAIN_WIDTH) that are made for the next
one; the arcs (c, 3) that are to be tried; a heap of either, priorities and numbers (int64); the buckets (b,) int64 that
tell which chains end alike; the clock; and what an arc is near to, see `bending.Nearby`."""


def beam_size(obstacles: int, width: int) -> int:
    """Numbers (float64) that a search works in beside its table, that keeps `width` chains, a power of two."""
    return LAZY * width * CHAIN_WIDTH + 5 * width * ARCS + 4 * width + CLOCK_SIZE + 2 * obstacles


def carve_beam(levels: Array, buffer: Array, obstacles: int) -> Beam:
    """Lay out the memory of a search, see `beam_size`."""
    width = levels.shape[1]
    chains, rest = cut(buffer, LAZY * width, CHAIN_WIDTH)
    arcs, rest = cut(rest, width * ARCS, 3)
    priority, rest = cut(rest, width * ARCS)
    items, rest = cut_whole(rest, width * ARCS)
    buckets, rest = cut_whole(rest, 4 * width)
    clock, rest = cut_whole(rest, CLOCK_SIZE)
    numbers, rest = cut_whole(rest, obstacles)
    until, rest = cut(rest, obstacles)
    return Beam(levels, chains, arcs, priority, items, buckets, clock, Nearby(numbers, until))


def empty_buckets(beam: Beam) -> None:
    """Forget which chains end alike."""
    for i in range(beam.buckets.shape[0]):
        beam.buckets[i] = 0


def _bucket(pose: tuple[Mat, Vec], edge: float, turns: float) -> int:
    """Number of the bucket of a chain: its end lies in the same cube and points into much the same direction."""
    r, p = pose
    key = 1
    for x in (p[0] / edge, p[1] / edge, p[2] / edge, turns * r[0][2], turns * r[1][2], turns * r[2][2]):
        key = key * 1000003 + math.floor(x + 0.5)
    return key | 1


def note_new_end(beam: Beam, pose: tuple[Mat, Vec], edge: float, turns: float) -> bool:
    """Whether no chain was noted yet that ends alike; this one is noted from then on.

    There are more buckets than chains that are ever noted.
    """
    key = _bucket(pose, edge, turns)
    mask = beam.buckets.shape[0] - 1
    at = int((np.uint64(key) * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(40)) & mask
    while beam.buckets[at] != 0:
        if beam.buckets[at] == key:
            return False
        at = (at + 1) & mask
    beam.buckets[at] = key
    return True


def _copy_chain(level: Array, to: int, chains: Array, i: int) -> None:
    for j in range(CHAIN_WIDTH):
        level[to, j] = chains[i, j]


def keep_best(beam: Beam, k: int, count: int, segment: float) -> int:
    """Keep the best of the `count` chains that were made as those of `k` segments; returns how many.

    At first none that ends as a better one does, and only some that continue the same one: these share what is wrong
    with it. The others fill up what is left of the beam. `segment` is the mean length of one.
    """
    level, before, width = beam.levels[k], beam.levels[k - 1], beam.levels.shape[1]
    children = 1 + width // FAN if k > 1 else width
    for i in range(width):
        before[i, CHILDREN] = 0.0
    empty_buckets(beam)
    size = kept = others = 0
    for i in range(count):
        size = heap.push(beam.heap, beam.items, size, beam.made[i, SCORE], i)
    while size > 0 and kept < width:
        i, size = heap.pop(beam.heap, beam.items, size)
        parent = int(beam.made[i, PARENT])
        if before[parent, CHILDREN] < children and note_new_end(
            beam, frame(beam.made, i), END_SPACING * segment, TANGENT_CELLS
        ):
            before[parent, CHILDREN] += 1.0
            _copy_chain(level, kept, beam.made, i)
            kept += 1
        else:
            others += 1
            beam.items[beam.items.shape[0] - others] = i
    for other in range(1, min(others, width - kept) + 1):
        _copy_chain(level, kept, beam.made, beam.items[beam.items.shape[0] - other])
        kept += 1
    return kept
