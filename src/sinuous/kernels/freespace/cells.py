"""The cells of a grid that a search has met, in a hash table; and the memory that a search works in.

Cells are cubes, numbered by three whole numbers from the one about the origin. A cell is entered when it is first met:
no grid is laid out beforehand, and in a narrow place few cells are met at all. What a search notes of a cell lies in
arrays with one place for each slot of the table.
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.compile import kernel
from sinuous.kernels.maths.vectors import Array

CellTable = namedtuple("CellTable", ["keys", "distance", "penalized"])
"""An open-addressed hash table of cells. By slot: `keys` (s,) int64, 0 where the slot is empty; `distance` (s,) of the
cell's middle to the obstacles, -inf where it cannot be passed; `penalized` (s,) uint8, whether it is near a route that
is known already."""

Side = namedtuple("Side", ["before", "cost", "length", "done", "priority", "items"])
"""What a search from one end notes. By slot of the table: `before` (s,) int32, the slot that the route comes from
(NONE: it begins here); `cost` (s,) and `length` (s,) float32 of the route; `done` (s,) uint8, whether its cost is
final. And the heap of slots that are open, see `heap`: `priority` (h,) and `items` (h,) int32."""

Memory = namedtuple("Memory", ["table", "side", "points", "clock"])
"""All that a search works in: table, side, `points` (m, 3) of a line, and scratch (2,) of the clock."""

NONE = -1

HEAP_SHARE = 1
"""Places in the heap for each slot of the table: two for each cell, as half of the slots stay empty."""

LINE_POINTS = 8192
"""Most cells that a route leads through."""

OFFSET = 1 << 20
"""Numbers of cells are counted from here, so that they are positive; twenty-one bits each."""


def memory_size(slots: int) -> int:
    """Numbers (float64) that a search with so many slots, a power of two from 8 on, works in: 46 bytes a slot."""
    return 3 * slots + slots // 2 * 2 + slots // 8 * 2 + HEAP_SHARE * (slots + slots // 2) + 3 * LINE_POINTS + 2


@kernel
def carve(buffer: Array, slots: int) -> Memory:
    """Lay out the memory of a search in the beginning of `buffer`, see `memory_size`."""
    t, half, eighth = slots, slots >> 1, slots >> 3
    h = HEAP_SHARE * slots
    small = buffer[3 * t + h :]
    rest = small[t + 2 * eighth + (h >> 1) :]
    side = Side(
        small[:half].view(np.int32),
        buffer[2 * t : 3 * t],
        small[half:t].view(np.float32),
        small[t : t + eighth].view(np.uint8),
        buffer[3 * t : 3 * t + h],
        small[t + 2 * eighth : t + 2 * eighth + (h >> 1)].view(np.int32),
    )
    table = CellTable(buffer[:t].view(np.int64), buffer[t : 2 * t], small[t + eighth : t + 2 * eighth].view(np.uint8))
    lines = 3 * LINE_POINTS
    return Memory(table, side, rest[:lines].reshape((LINE_POINTS, 3)), rest[lines : lines + 2].view(np.int64))


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
def find_slot(table: CellTable, key: int) -> int:
    """Slot of a cell, or the empty one where it belongs; one slot at least must be empty."""
    mask = table.keys.shape[0] - 1
    at = int((np.uint64(key) * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(20)) & mask
    while table.keys[at] != 0 and table.keys[at] != key:
        at = (at + 1) & mask
    return at


@kernel
def add_cell(table: CellTable, side: Side, slot: int, key: int, distance: float) -> None:
    """Take a new cell into its empty slot; no route leads to it yet."""
    table.keys[slot] = key
    table.distance[slot] = distance
    table.penalized[slot] = 0
    side.cost[slot] = math.inf
    side.length[slot] = 0.0
    side.done[slot] = 0


@kernel
def clear(table: CellTable) -> None:
    """Forget all cells."""
    for i in range(table.keys.shape[0]):
        table.keys[i] = 0


@kernel
def restart(table: CellTable, side: Side) -> None:
    """Forget all routes, but keep the cells with their distances and penalties."""
    for i in range(table.keys.shape[0]):
        if table.keys[i] != 0:
            side.cost[i] = math.inf
            side.done[i] = 0
