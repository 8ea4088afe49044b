"""Weighted A* over the cells of a grid from both ends, until they meet (Hart et al. 1968, Pohl 1970 and 1971).

A cell can be passed when its middle is no nearer than `clearance` to any obstacle. With `radius - HALF_DIAGONAL * cell`
this is so wherever a point of the backbone can lie in it, because distance changes by at most the distance moved. What
can be passed is the same from both ends: where one of them runs dry there is no route, for any robot, however large the
room around the other one is. A route that is found may still be too narrow: cells cost more the less room they leave.

From each end a search heads for the other one, and the one with fewer open cells goes on: the one in the narrower
place. With w for `inflation`, c for the cost of the cheapest route and d for the distance between the ends: some cell
of the cheapest route is open on either side, with a priority of at most w c. Thus both costs of a cell that both sides
are done with are at most w c - w times what is left to the other end, in a straight line. The search ends with the
cheapest route known when there is such a cell, so it costs at most w (2 c - d); in a narrow place an end that bounds it
by w c takes as long as two searches. Where the least priority of one side already says w c it ends sooner.
"""

import math

from sinuous.kernels.clock import spend
from sinuous.kernels.compile import inline, kernel
from sinuous.kernels.fields.distances import Scene
from sinuous.kernels.fields.distances import price as looks_of
from sinuous.kernels.freespace.cells import (
    NONE,
    Memory,
    Side,
    add_cell,
    cell_of,
    key_of,
    numbers_of,
    pick,
    pop,
    push,
)
from sinuous.kernels.freespace.grid import HALF_DIAGONAL, Grid, cell_at, free_distance, middle, price, walled
from sinuous.kernels.maths.vectors import Vec, norm, sub
from sinuous.kernels.tables import CLOSED, FOUND, FULL, TIMED_OUT

FROM_GOAL, FROM_START = 0, 1
"""The sides of a search."""

SMOOTHED = 0.9
"""What is left of the length of a route when its corners are cut: cells are left in 26 directions only."""

DETOUR = 2.0
"""Surcharge on a unit of length near a route that is known already, so that the next one differs."""

SEEDS = 0.25
"""Most of the table that the cells about one end may take. About a larger ball nothing is searched from: the other side
ends when it gets there."""

AROUND = 27
"""Cells that a look at all neighbours of one may add to the table, and to a heap."""


@kernel
def _end(grid: Grid, which: int) -> tuple[Vec, float]:
    """Where routes of a side begin: within a ball about a place."""
    if which == FROM_GOAL:
        return grid.goal, grid.goal_radius + HALF_DIAGONAL * grid.cell
    return grid.start, grid.start_radius


@kernel
def _arrive(other: Side, cell: int, rest: float, close: float) -> None:
    """Note of a cell that is as near to the place of the other side as its routes begin, how far it is from there."""
    if rest <= close and rest < other.cost[cell]:
        other.cost[cell], other.length[cell], other.before[cell] = rest, rest, NONE


@kernel
def _seed(memory: Memory, grid: Grid, scene: Scene, which: int) -> bool:
    """Open the cells that have their middles in the ball where a side begins; say whether they are not too many."""
    table, side, other = memory.table, pick(memory.sides, which), pick(memory.sides, 1 - which)
    place, around = _end(grid, which)
    aim, close = _end(grid, 1 - which)
    span = math.ceil(around / grid.cell) + 1
    if (2.0 * span + 1.0) ** 3 > SEEDS * table.keys.shape[0]:
        return False
    looks = looks_of(scene)
    x, y, z = numbers_of(cell_at(grid, place))
    for i in range(-span, span + 1):
        for j in range(-span, span + 1):
            for k in range(-span, span + 1):
                key = key_of(x + i, y + j, z + k)
                off = norm(sub(middle(grid, key), place))
                if off > around:
                    continue
                if table.size[0] == table.keys.shape[0] or spend(memory.clock, looks):
                    return True
                cell = cell_of(table, key)
                if cell == NONE:
                    cell = add_cell(table, memory.sides, key, free_distance(grid, scene, middle(grid, key)))
                if table.distance[cell] > -math.inf:
                    _arrive(side, cell, off, around)
                    _arrive(other, cell, norm(sub(middle(grid, key), aim)), close)
                    push(side, 0.0, cell)
    return True


@kernel
def _through(sides: Side, cell: int) -> float:
    """Cost of the route through a cell that both sides have come to; infinite without one."""
    return math.inf if cell == NONE else sides.cost[FROM_GOAL, cell] + sides.cost[FROM_START, cell]


@kernel
def _joins(sides: Side, grid: Grid, cell: int, met: int) -> bool:
    """Whether the route through `cell` is cheaper than that through `met`, and not too long."""
    length = sides.length[FROM_GOAL, cell] + sides.length[FROM_START, cell]
    return _through(sides, cell) < _through(sides, met) and SMOOTHED * length <= grid.longest


cell_of_here, push_here = inline(cell_of), inline(push)


@kernel
def _widen(memory: Memory, grid: Grid, scene: Scene, which: int, cell: int, met: int) -> int:
    """Look at the neighbours of a cell; returns the cell that the cheapest route known so far leads through."""
    table, side, other = memory.table, pick(memory.sides, which), pick(memory.sides, 1 - which)
    aim, close = _end(grid, 1 - which)
    x, y, z = numbers_of(table.keys[cell])
    h, looks = grid.cell, looks_of(scene)
    own = price(grid, table.distance[cell]) + DETOUR * table.penalized[cell]
    for i in range(-1, 2):
        for j in range(-1, 2):
            for k in range(-1, 2):
                key = key_of(x + i, y + j, z + k)
                new = cell_of_here(table, key)
                if new == NONE:
                    new = add_cell(table, memory.sides, key, free_distance(grid, scene, middle(grid, key)))
                    spend(memory.clock, looks)
                d = table.distance[new]
                if d == -math.inf or side.done[new] != 0:
                    continue
                step = h * math.sqrt(i * i + j * j + k * k)
                if d + table.distance[cell] < step:
                    spend(memory.clock, looks)
                    if walled(grid, scene, table.keys[cell], key):
                        continue
                cost = side.cost[cell] + 0.5 * step * (own + price(grid, d) + DETOUR * table.penalized[new])
                length = side.length[cell] + step
                rest = norm(sub(middle(grid, key), aim))
                if cost < side.cost[new] and SMOOTHED * length + rest <= grid.longest:
                    side.cost[new], side.length[new], side.before[new] = cost, length, cell
                    push_here(side, cost + grid.inflation * rest, new)
                    if rest <= close:
                        _arrive(other, new, rest, close)
                    if other.cost[new] < math.inf and _joins(memory.sides, grid, new, met):
                        met = new
    return met


@kernel
def _least(side: Side) -> float:
    """Least priority of a side; infinite when it is dry."""
    return side.priority[0] if side.size[0] > 0 else math.inf


@kernel
def explore(memory: Memory, grid: Grid, scene: Scene) -> tuple[int, int]:
    """Search from the cells about the goal and from those about the start; what was searched before is in the memory.

    Returns FOUND, CLOSED (no route), FULL (the table or a heap is) or TIMED_OUT; and the cell in which both sides met
    (NONE: there is no route). From there `before` of each side leads to its end.
    """
    table, sides = memory.table, memory.sides
    goal_side, start_side = pick(sides, FROM_GOAL), pick(sides, FROM_START)
    most, places = table.keys.shape[0] - AROUND, goal_side.items.shape[0] - AROUND
    from_goal = _seed(memory, grid, scene, FROM_GOAL)
    from_start = _seed(memory, grid, scene, FROM_START)
    if not from_goal and not from_start:
        return FULL, NONE
    met = NONE
    for cell in range(table.size[0]):
        if _joins(sides, grid, cell, met):
            met = cell
    while True:
        if spend(memory.clock, AROUND):
            return TIMED_OUT, NONE
        least_from_goal = _least(goal_side) if from_goal else 0.0
        least_from_start = _least(start_side) if from_start else 0.0
        if met != NONE and _through(sides, met) <= max(least_from_goal, least_from_start):
            return FOUND, met
        if max(least_from_goal, least_from_start) == math.inf:
            return CLOSED, NONE
        fewer = start_side.size[0] < goal_side.size[0]
        which = FROM_START if from_start and (fewer or not from_goal) else FROM_GOAL
        side = pick(sides, which)
        if table.size[0] > most or side.size[0] > places:
            return FULL, NONE
        cell = pop(side)
        if side.done[cell] != 0:
            continue
        side.done[cell] = 1
        if sides.done[1 - which, cell] != 0 and met != NONE:
            return FOUND, met
        met = _widen(memory, grid, scene, which, cell, met)


@kernel
def penalize(memory: Memory, met: int, around: int) -> None:
    """Make the route through the cell `met`, and all cells up to `around` cells from it, dearer."""
    table = memory.table
    for which in range(2):
        cell = met
        while cell != NONE:
            x, y, z = numbers_of(table.keys[cell])
            for i in range(-around, around + 1):
                for j in range(-around, around + 1):
                    for k in range(-around, around + 1):
                        near = cell_of(table, key_of(x + i, y + j, z + k))
                        if near != NONE:
                            table.penalized[near] = 1
            cell = int(memory.sides.before[which, cell])
