"""The cells of a grid that a search has met, in a hash table; and the memory that a search works in.

Cells are cubes, numbered by three whole numbers from the one about the origin. A cell is entered when it is first met:
no grid is laid out beforehand, and in a narrow place few cells are met at all. Cells are counted in the order in which
they are met, and what is noted of them lies in arrays by that number: cells that are neighbours mostly lie together
there, and memory that no cell came to is never touched.
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.compile import kernel
from sinuous.kernels.maths import heap
from sinuous.kernels.maths.vectors import Array

CellTable = namedtuple("CellTable", ["index", "size", "keys", "distance", "penalized"])
"""The cells that were met, by number: `keys` (c,) int64; `distance` (c,) of the cell's middle to the obstacles, -inf
where it cannot be passed; `penalized` (c,) uint8, whether it is near a route that is known already. `index` (2 c,)
int32 is an open-addressed hash table: by slot, one more than the number of the cell, 0 where the slot is empty. `size`
(2,) int64: how many cells there are, and how many slots are in use, a power of two that grows with the cells."""

Side = namedtuple("Side", ["before", "cost", "length", "done", "priority", "items", "size"])
"""What the search from one end notes. By number of the cell: `before` (c,) int32, the cell that the route comes from
(NONE: it begins here); `cost` (c,) and `length` (c,) float32 of the route; `done` (c,) uint8, whether its cost is
final. And the heap of cells that are open, see `heap`: `priority` (h,), `items` (h,) int32 and `size` (1,) int64."""

Memory = namedtuple("Memory", ["table", "sides", "points", "clock"])
"""All that a search works in: table, both sides (arrays with one more axis in front, see `pick`), `points` (m, 3) of a
line, and the clock, see `kernels.clock`."""

NONE = -1

FIRST_SLOTS = 1 << 10
"""Slots of the hash table before it grows."""

LINE_POINTS = 8192
"""Most cells that a route leads through."""

OFFSET = 1 << 20
"""Numbers of cells are counted from here, so that they are positive; twenty-one bits each."""


def memory_size(most: int) -> int:
    """Numbers (float64) that a search works in that meets `most` cells, a power of two from 8 on: 83 bytes a cell."""
    return 10 * most + 3 * (most // 8) + 3 * LINE_POINTS + CLOCK_SIZE + 4


@kernel
def carve(buffer: Array, most: int) -> Memory:
    """Lay out the memory of a search in the beginning of `buffer`, see `memory_size`."""
    c, eighth = most, most >> 3
    sides = Side(
        buffer[:c].view(np.int32).reshape((2, c)),
        buffer[c : 3 * c].reshape((2, c)),
        buffer[3 * c : 4 * c].view(np.float32).reshape((2, c)),
        buffer[10 * c : 10 * c + 2 * eighth].view(np.uint8).reshape((2, c)),
        buffer[4 * c : 6 * c].reshape((2, c)),
        buffer[6 * c : 7 * c].view(np.int32).reshape((2, c)),
        buffer[10 * c + 3 * eighth : 10 * c + 3 * eighth + 2].view(np.int64).reshape((2, 1)),
    )
    rest = buffer[10 * c + 3 * eighth + 2 :]
    table = CellTable(
        buffer[7 * c : 8 * c].view(np.int32),
        rest[:2].view(np.int64),
        buffer[8 * c : 9 * c].view(np.int64),
        buffer[9 * c : 10 * c],
        buffer[10 * c + 2 * eighth : 10 * c + 3 * eighth].view(np.uint8),
    )
    clock, points = rest[2 : 2 + CLOCK_SIZE].view(np.int64), rest[2 + CLOCK_SIZE :]
    return Memory(table, sides, points[: 3 * LINE_POINTS].reshape((LINE_POINTS, 3)), clock)


@kernel
def pick(sides: Side, i: int) -> Side:
    """Side 0 or 1."""
    return Side(
        sides.before[i],
        sides.cost[i],
        sides.length[i],
        sides.done[i],
        sides.priority[i],
        sides.items[i],
        sides.size[i],
    )


@kernel
def key_of(x: int, y: int, z: int) -> int:
    """Key of a cell by its three numbers."""
    return ((x + OFFSET) << 42) | ((y + OFFSET) << 21) | (z + OFFSET)


@kernel
def numbers_of(key: int) -> tuple[int, int, int]:
    """The three numbers of a cell by its key."""
    mask = 2 * OFFSET - 1
    return (key >> 42) - OFFSET, ((key >> 21) & mask) - OFFSET, (key & mask) - OFFSET


@kernel
def home(table: CellTable, key: int) -> int:
    """Slot of the hash table where the search for a cell begins."""
    # All three numbers count in the high bits of the product alone; in the low ones x does not.
    return int((np.uint64(key) * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(44)) & (table.size[1] - 1)


@kernel
def find_slot(table: CellTable, key: int) -> int:
    """Slot of a cell in the hash table, or the empty one where it belongs; one slot at least must be empty."""
    mask, at = table.size[1] - 1, home(table, key)
    while table.index[at] != 0 and table.keys[table.index[at] - 1] != key:
        at = (at + 1) & mask
    return at


@kernel
def cell_of(table: CellTable, key: int) -> int:
    """Return the number of a cell; NONE where it was not met yet."""
    return int(table.index[find_slot(table, key)]) - 1


@kernel
def add_cell(table: CellTable, sides: Side, key: int, distance: float) -> int:
    """Take in a new cell, to which no route leads yet; there must be a place for it. Returns its number."""
    cell = table.size[0]
    table.keys[cell], table.distance[cell], table.penalized[cell] = key, distance, 0
    for i in range(2):
        sides.before[i, cell], sides.cost[i, cell], sides.length[i, cell], sides.done[i, cell] = NONE, math.inf, 0.0, 0
    table.size[0] = cell + 1
    if 2 * (cell + 1) > table.size[1]:
        _grow(table)
    table.index[find_slot(table, key)] = cell + 1
    return int(cell)


@kernel
def _grow(table: CellTable) -> None:
    """Take twice as many slots into use."""
    table.size[1] *= 2
    for i in range(table.size[1]):
        table.index[i] = 0
    for cell in range(table.size[0]):
        table.index[find_slot(table, table.keys[cell])] = cell + 1


@kernel
def clear(memory: Memory) -> None:
    """Forget all cells."""
    table = memory.table
    table.size[0], table.size[1] = 0, min(FIRST_SLOTS, table.index.shape[0])
    for i in range(table.size[1]):
        table.index[i] = 0
    restart(memory)


@kernel
def restart(memory: Memory) -> None:
    """Forget all routes, but keep the cells with their distances and penalties."""
    sides = memory.sides
    for i in range(2):
        sides.size[i, 0] = 0
        for cell in range(memory.table.size[0]):
            sides.cost[i, cell], sides.done[i, cell] = math.inf, 0


@kernel
def push(side: Side, priority: float, cell: int) -> None:
    """Put a cell into the heap of a side; there must be a place for it."""
    side.size[0] = heap.push(side.priority, side.items, side.size[0], priority, cell)


@kernel
def pop(side: Side) -> int:
    """Take out a cell of the least priority; there must be one."""
    cell, side.size[0] = heap.pop(side.priority, side.items, side.size[0])
    return int(cell)
