"""The cells that a search has met, by blocks of eight in a hash table; and the memory that a search works in.

A block holds the eight children of a cell that was divided, see `octree`. It is entered when it is first entered:
no grid is laid out beforehand, and in a narrow place few are met at all. Blocks are counted in the order in which they
are met, cells by their block: cell `8 b + octant`. What is noted of cells lies in arrays by that number, so neighbours
mostly lie together there, and memory that no cell came to is never touched.
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.compile import inline
from sinuous.kernels.freespace.keys import child_of
from sinuous.kernels.maths import heap
from sinuous.kernels.maths.shapes import shaped
from sinuous.kernels.maths.vectors import Array

CellTable = namedtuple("CellTable", ["index", "size", "parents", "cuts", "distance", "penalized"])
"""The cells that were met. By number of the block: `parents` (c / 8,) int64, key of the cell that it divides; `cuts`
(c / 8,) int32, the wall that cuts it in two, see `cut_cells`, or NONE where it is divided into eight. By number
of the cell: `distance` (c,) of its middle to the obstacles, or one of UNKNOWN, DIVIDED and BLOCKED; `penalized` (c,)
uint8, whether it is near a route that is known already. `index` (c / 4,) int32 is an open-addressed hash table: by
slot, one more than the number of the block, 0 where the slot is empty. `size` (4,) int64: how many blocks there are,
how many slots are in use, a power of two that grows with them; how many cells were examined, and whether (0, 1)
something found no place."""

BLOCKS, SLOTS, EVALUATED, OVERFLOW = range(4)
"""Places in `size`."""

Side = namedtuple("Side", ["before", "cost", "length", "points", "done", "priority", "items", "size"])
"""What the search from one end notes. By number of the cell: `before` (c,) int32, the cell that the route comes from
(NONE: it begins here); `cost` (c,) and `length` (c,) float32 of the route; `points` (c, 3), where it enters the
cell; `done` (c,) uint8, whether its cost is final. And the heap of cells that are open, see `heap`: `priority` (c,),
`items` (c,) int32 and `size` (1,) int64: how many there are."""

Memory = namedtuple("Memory", ["table", "sides", "points", "stack", "clock"])
"""All that a search works in: table, both sides (arrays with one more axis in front, see `pick`), `points` (m, 3) of a
line, keys (STACK,) int64 of cells that are yet to be entered, and the clock, see `kernels.clock`."""

NONE = -1

BLOCKED, UNKNOWN, DIVIDED = -math.inf, -2e300, -1e300
"""In the place of a distance: a cell that cannot be passed, one that nobody examined, and one that has a block of its
own. Whatever is larger is the distance of a cell that can be passed."""

FIRST_SLOTS = 1 << 8
"""Slots of the hash table before it grows."""

LINE_POINTS = 8192
"""Most cells that a route leads through."""

STACK = 128


def memory_size(most: int) -> int:
    """Numbers (float64) that a search works in that meets `most` cells, a power of two from 64 on: 118 bytes a cell."""
    return 14 * most + 5 * (most // 8) + most // 16 + 3 * LINE_POINTS + STACK + CLOCK_SIZE + 6


def carve(buffer: Array, most: int) -> Memory:
    """Lay out the memory of a search in the beginning of `buffer`, see `memory_size`."""
    c, eighth = most, most >> 3
    small = buffer[14 * c :]
    rest = small[5 * eighth + (eighth >> 1) :]
    sides = Side(
        shaped(buffer[:c].view(np.int32), (2, c)),
        shaped(buffer[c : 3 * c], (2, c)),
        shaped(buffer[3 * c : 4 * c].view(np.float32), (2, c)),
        shaped(buffer[4 * c : 10 * c], (2, c, 3)),
        shaped(small[: 2 * eighth].view(np.uint8), (2, c)),
        shaped(buffer[10 * c : 12 * c], (2, c)),
        shaped(buffer[12 * c : 13 * c].view(np.int32), (2, c)),
        shaped(rest[:2].view(np.int64), (2, 1)),
    )
    table = CellTable(
        small[2 * eighth : 3 * eighth].view(np.int32),
        rest[2:6].view(np.int64),
        small[3 * eighth : 4 * eighth].view(np.int64),
        small[5 * eighth : 5 * eighth + (eighth >> 1)].view(np.int32),
        buffer[13 * c : 14 * c],
        small[4 * eighth : 5 * eighth].view(np.uint8),
    )
    stack, clock = rest[6 : 6 + STACK].view(np.int64), rest[6 + STACK :][:CLOCK_SIZE].view(np.int64)
    points = shaped(rest[6 + STACK + CLOCK_SIZE :][: 3 * LINE_POINTS], (LINE_POINTS, 3))
    return Memory(table, sides, points, stack, clock)


def pick(sides: Side, i: int) -> Side:
    """Side 0 or 1."""
    return Side(
        sides.before[i],
        sides.cost[i],
        sides.length[i],
        sides.points[i],
        sides.done[i],
        sides.priority[i],
        sides.items[i],
        sides.size[i],
    )


def _first_slot(table: CellTable, key: int) -> int:
    """Slot of the hash table where the search for a block begins."""
    # All numbers of a key count in the high bits of the product alone; in the low ones x does not.
    return int((np.uint64(key) * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(44)) & (table.size[SLOTS] - 1)


def find_slot(table: CellTable, key: int) -> int:
    """Slot of the block of a cell in the hash table, or the empty one where it belongs; one slot must be empty."""
    mask, at = table.size[SLOTS] - 1, _first_slot(table, key)
    while table.index[at] != 0 and table.parents[table.index[at] - 1] != key:
        at = (at + 1) & mask
    return at


find_slot_here = inline(find_slot)


def block_of(table: CellTable, key: int) -> int:
    """Return the number of the block of a cell; NONE where it has none."""
    return int(table.index[find_slot_here(table, key)]) - 1


def key_in(table: CellTable, cell: int) -> int:
    """Key of the cell with a number; of a half, that of the whole."""
    if table.cuts[cell >> 3] != NONE:
        return int(table.parents[cell >> 3])
    return int(child_of(table.parents[cell >> 3], cell & 7))


def add_block(memory: Memory, key: int, cut: int) -> int:
    """Give a cell a block of its own, of cells that nobody examined; NONE where there is no place left.

    `cut` is the wall that cuts it in two, NONE: it is divided into eight.
    """
    table, sides = memory.table, memory.sides
    block = table.size[BLOCKS]
    if block == table.parents.shape[0]:
        table.size[OVERFLOW] = 1
        return NONE
    table.parents[block], table.cuts[block] = key, cut
    for cell in range(8 * block, 8 * block + 8):
        table.distance[cell], table.penalized[cell] = UNKNOWN, 0
        for i in range(2):
            sides.cost[i, cell], sides.done[i, cell] = math.inf, 0
    table.size[BLOCKS] = block + 1
    if 2 * (block + 1) > table.size[SLOTS]:
        _grow(table)
    table.index[find_slot(table, key)] = block + 1
    return int(block)


def _grow(table: CellTable) -> None:
    """Take twice as many slots into use."""
    table.size[SLOTS] *= 2
    for i in range(table.size[SLOTS]):
        table.index[i] = 0
    for block in range(table.size[BLOCKS] - 1):
        table.index[find_slot(table, table.parents[block])] = block + 1


def forget_cells(memory: Memory) -> None:
    """Forget all cells."""
    table = memory.table
    table.size[BLOCKS], table.size[SLOTS], table.size[EVALUATED] = 0, min(FIRST_SLOTS, table.index.shape[0]), 0
    for i in range(table.size[SLOTS]):
        table.index[i] = 0
    forget_routes(memory)


def forget_routes(memory: Memory) -> None:
    """Forget all routes, but keep the cells with their distances and penalties."""
    sides = memory.sides
    memory.table.size[OVERFLOW] = 0
    for i in range(2):
        sides.size[i, 0] = 0
        for cell in range(8 * memory.table.size[BLOCKS]):
            sides.cost[i, cell], sides.done[i, cell] = math.inf, 0


def push_cell(memory: Memory, which: int, priority: float, cell: int) -> None:
    """Put a cell into the heap of a side, if there is a place for it."""
    side = pick(memory.sides, which)
    if side.size[0] == side.items.shape[0]:
        memory.table.size[OVERFLOW] = 1
        return
    side.size[0] = heap.push(side.priority, side.items, side.size[0], priority, cell)


def pop_cell(side: Side) -> int:
    """Take out a cell of the least priority; there must be one."""
    cell, side.size[0] = heap.pop(side.priority, side.items, side.size[0])
    return int(cell)
