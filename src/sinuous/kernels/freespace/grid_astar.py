"""Weighted A* over the cells of a grid (Hart et al. 1968, Pohl 1970), from the goal to the start.

A cell can be passed when its middle is no nearer than `clearance` to any obstacle. With `radius - HALF_DIAGONAL * cell`
this is so wherever a point of the backbone can lie in it, because distance changes by at most the distance moved:
where the search runs dry then, there is no route, for any robot. A route that is found may still be too narrow: cells
cost more the less room they leave.
"""

import math

from sinuous.kernels.clock import now
from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import Scene
from sinuous.kernels.freespace.cells import NONE, CellTable, Memory, Side, add_cell, find_slot, key_of, numbers_of
from sinuous.kernels.freespace.grid import HALF_DIAGONAL, Grid, cell_at, free_distance, middle, price, walled
from sinuous.kernels.maths import heap
from sinuous.kernels.maths.vectors import norm, sub
from sinuous.kernels.tables import CLOSED, FOUND, FULL, TIMED_OUT

SMOOTHED = 0.9
"""What is left of the length of a route when its corners are cut: cells are left in 26 directions only."""

DETOUR = 2.0
"""Surcharge on a unit of length near a route that is known already, so that the next one differs."""


@kernel
def _seed(table: CellTable, side: Side, grid: Grid, scene: Scene, most: int) -> tuple[int, int]:
    """Open the cells that the ball about the goal touches; returns the size of the heap and the number of new cells.

    No more than `most` are taken: in a full table the search for a slot would never end.
    """
    size = entered = 0
    h, around = grid.cell, grid.goal_radius
    span = math.ceil(around / h) + 1
    x, y, z = numbers_of(cell_at(grid, grid.goal))
    for i in range(-span, span + 1):
        for j in range(-span, span + 1):
            for k in range(-span, span + 1):
                key = key_of(x + i, y + j, z + k)
                off = norm(sub(middle(grid, key), grid.goal))
                if off > around + HALF_DIAGONAL * h:
                    continue
                slot = find_slot(table, key)
                if table.keys[slot] == 0:
                    if entered >= most:
                        return size, entered
                    add_cell(table, side, slot, key, free_distance(grid, scene, middle(grid, key)))
                    entered += 1
                if table.distance[slot] > -math.inf:
                    side.cost[slot] = off
                    side.length[slot] = off
                    side.before[slot] = NONE
                    size = heap.push(side.priority, side.items, size, 0.0, slot)
    return size, entered


@kernel
def _widen(
    table: CellTable, side: Side, grid: Grid, scene: Scene, slot: int, size: int, entered: int
) -> tuple[int, int]:
    """Look at the neighbours of a cell; returns the size of the heap and the number of cells in the table."""
    x, y, z = numbers_of(table.keys[slot])
    h = grid.cell
    own = price(grid, table.distance[slot]) + DETOUR * table.penalized[slot]
    for i in range(-1, 2):
        for j in range(-1, 2):
            for k in range(-1, 2):
                key = key_of(x + i, y + j, z + k)
                other = find_slot(table, key)
                if table.keys[other] == 0:
                    add_cell(table, side, other, key, free_distance(grid, scene, middle(grid, key)))
                    entered += 1
                d = table.distance[other]
                if d == -math.inf or side.done[other] != 0:
                    continue
                step = h * math.sqrt(i * i + j * j + k * k)
                if d + table.distance[slot] < step and walled(grid, scene, table.keys[slot], key):
                    continue
                cost = side.cost[slot] + 0.5 * step * (own + price(grid, d) + DETOUR * table.penalized[other])
                length = side.length[slot] + step
                rest = norm(sub(middle(grid, key), grid.start))
                if cost < side.cost[other] and SMOOTHED * length + rest <= grid.longest:
                    side.cost[other] = cost
                    side.length[other] = length
                    side.before[other] = slot
                    size = heap.push(side.priority, side.items, size, cost + grid.inflation * rest, other)
    return size, entered


@kernel
def explore(memory: Memory, grid: Grid, scene: Scene, deadline: float, entered: int) -> tuple[int, int, int]:
    """Search from the cells about the goal to those about the start; `entered` cells are in the table already.

    Returns FOUND, CLOSED (no route), FULL (the table or the heap is) or TIMED_OUT; the slot that the route begins with
    (NONE: there is no route); and how many cells are in the table then.
    """
    table, side = memory.table, memory.side
    most = table.keys.shape[0] // 2
    size, new = _seed(table, side, grid, scene, most - entered)
    entered += new
    if entered >= most:
        return FULL, NONE, entered
    looks = 0
    while size > 0:
        if entered + 27 > most or size + 27 > side.items.shape[0]:
            return FULL, NONE, entered
        looks += 1
        if looks % 64 == 0 and now(memory.clock) > deadline:
            return TIMED_OUT, NONE, entered
        slot, size = heap.pop(side.priority, side.items, size)
        if side.done[slot] != 0:
            continue
        side.done[slot] = 1
        if norm(sub(middle(grid, table.keys[slot]), grid.start)) <= grid.start_radius:
            return FOUND, slot, entered
        size, entered = _widen(table, side, grid, scene, slot, size, entered)
    return CLOSED, NONE, entered


@kernel
def penalize(table: CellTable, side: Side, slot: int, around: int) -> None:
    """Make the route that begins with `slot`, and all cells up to `around` cells from it, dearer."""
    while slot >= 0:
        x, y, z = numbers_of(table.keys[slot])
        for i in range(-around, around + 1):
            for j in range(-around, around + 1):
                for k in range(-around, around + 1):
                    other = find_slot(table, key_of(x + i, y + j, z + k))
                    if table.keys[other] != 0:
                        table.penalized[other] = 1
        slot = side.before[slot]
