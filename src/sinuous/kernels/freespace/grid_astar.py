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
from collections import namedtuple

from sinuous.kernels.clock import spend
from sinuous.kernels.compile import inline
from sinuous.kernels.fields.distances import Scene, work_of_all
from sinuous.kernels.freespace.cells import (
    BLOCKED,
    BLOCKS,
    DIVIDED,
    NONE,
    OVERFLOW,
    UNKNOWN,
    Memory,
    Side,
    add_block,
    block_of,
    key_in,
    pick,
    pop_cell,
    push_cell,
)
from sinuous.kernels.freespace.cut_cells import common_box, distance_beyond, linked, place_beside
from sinuous.kernels.freespace.grid import HALF_DIAGONAL, SearchGrid, cell_at, corners, cost_rate, has_wall, middle
from sinuous.kernels.freespace.keys import child_of, key_of, numbers_of, octant_of, touch
from sinuous.kernels.freespace.octree import LEAF, block_at, evaluate_cell, known_leaf, leaf_at
from sinuous.kernels.maths.vectors import Vec, add_scaled, get_vec, norm, put_vec, sub
from sinuous.kernels.tables import CLOSED, FOUND, FULL, TIMED_OUT

FROM_GOAL, FROM_START = 0, 1
"""The sides of a search."""

SMOOTHED = 0.9
"""What is left of the length of a route when its corners are cut: finest cells are left in 26 directions only."""

DETOUR = 2.0
"""Surcharge on a unit of length near a route that is known already, so that the next one differs."""

PENALIZED_CELLS = 2
"""Cells on all sides of a route that are made dearer before the next one is searched for."""

SEEDS = 0.25
"""Most of the table that the cells about one end may take. About a larger ball nothing is searched from: the other side
ends when it gets there."""

CELL_WORK = 27
"""Work units of a clock that one cell counts for."""

WALL_ITERATIONS = 4
"""How often a point beside a wall is put back between two cells."""

Here = namedtuple("Here", ["which", "cell", "key", "cut", "level", "point", "rate"])
"""The cell whose neighbours are examined, by one side: number and key of it; the wall that cuts it; its level; where
the route enters it; and what a unit of length costs there."""


def _end_ball(grid: SearchGrid, which: int) -> tuple[Vec, float]:
    """Where routes of a side begin: within a ball about a place."""
    if which == FROM_GOAL:
        return grid.goal, grid.goal_radius + HALF_DIAGONAL * grid.cell
    return grid.start, grid.start_radius


def _clamp(p: Vec, low: Vec, high: Vec) -> Vec:
    """The point between two corners that is nearest to `p`."""
    return (min(max(p[0], low[0]), high[0]), min(max(p[1], low[1]), high[1]), min(max(p[2], low[2]), high[2]))


def _begin_in_cell(side: Side, cell: int, off: float, p: Vec) -> None:
    """Note of a cell that the point `p` of it is within the ball where a side begins, and how far it is from there."""
    if off < side.cost[cell]:
        side.cost[cell], side.length[cell], side.before[cell] = off, off, NONE
        put_vec(side.points, cell, 0, p)


def _open_ends(memory: Memory, grid: SearchGrid, scene: Scene, which: int) -> bool:
    """Open the cells in which there are middles in the ball where a side begins; say whether they are not too many."""
    table, side, other = memory.table, pick(memory.sides, which), pick(memory.sides, 1 - which)
    place, around = _end_ball(grid, which)
    aim, close = _end_ball(grid, 1 - which)
    span = math.ceil(around / grid.cell) + 1
    if (2.0 * span + 1.0) ** 3 > SEEDS * table.distance.shape[0]:
        return False
    _, x, y, z = numbers_of(cell_at(grid, place))
    for i in range(-span, span + 1):
        for j in range(-span, span + 1):
            for k in range(-span, span + 1):
                key = key_of(0, x + i, y + j, z + k)
                p = middle(grid, key)
                off = norm(sub(p, place))
                if off > around:
                    continue
                if table.size[OVERFLOW] != 0 or spend(memory.clock, 1):
                    return True
                cell = leaf_at(memory, grid, scene, key)
                if cell != NONE:
                    new = side.cost[cell] == math.inf
                    _begin_in_cell(side, cell, off, p)
                    rest = norm(sub(p, aim))
                    if rest <= close:
                        _begin_in_cell(other, cell, rest, p)
                    if new:
                        push_cell(memory, which, 0.0, cell)
    return True


def _gap_between_routes(sides: Side, cell: int) -> float:
    """How far apart both routes enter a cell."""
    return norm(sub(get_vec(sides.points[FROM_GOAL], cell, 0), get_vec(sides.points[FROM_START], cell, 0)))


def _cost_through(memory: Memory, grid: SearchGrid, cell: int) -> float:
    """Cost of the route through a cell that both sides have come to; infinite without one."""
    sides = memory.sides
    if cell == NONE or sides.cost[FROM_GOAL, cell] + sides.cost[FROM_START, cell] == math.inf:
        return math.inf
    own = cost_rate(grid, memory.table.distance[cell]) + DETOUR * memory.table.penalized[cell]
    return sides.cost[FROM_GOAL, cell] + sides.cost[FROM_START, cell] + own * _gap_between_routes(sides, cell)


def _joins_cheaper(memory: Memory, grid: SearchGrid, cell: int, met: int) -> bool:
    """Whether the route through `cell` is cheaper than that through `met`, and not too long."""
    sides = memory.sides
    cost = _cost_through(memory, grid, cell)
    if cost == math.inf or cost >= _cost_through(memory, grid, met):
        return False
    length = sides.length[FROM_GOAL, cell] + sides.length[FROM_START, cell] + _gap_between_routes(sides, cell)
    return SMOOTHED * length <= grid.longest


def _entry_point(grid: SearchGrid, scene: Scene, here: Here, key: int, half: tuple[int, int], aim: Vec) -> Vec:
    """Where a route enters the cell `key`: in its middle if it is one of the finest, else where it leads to `aim`.

    The point of the face, edge or corner between both cells that the straight line meets, or is nearest to; beside the
    wall that cuts the cell, of which the wall and the side are `half`.
    """
    if numbers_of(key)[0] == 0:
        return middle(grid, key)
    low, high = common_box(grid, here.key, key)
    p, line = here.point, sub(aim, here.point)
    thin, fraction = 0.25 * grid.cell, 0.0
    if high[0] - low[0] < thin and line[0] != 0.0:
        fraction = max(fraction, min(1.0, (low[0] - p[0]) / line[0]))
    if high[1] - low[1] < thin and line[1] != 0.0:
        fraction = max(fraction, min(1.0, (low[1] - p[1]) / line[1]))
    if high[2] - low[2] < thin and line[2] != 0.0:
        fraction = max(fraction, min(1.0, (low[2] - p[2]) / line[2]))
    p = _clamp(add_scaled(p, fraction, line), low, high)
    if half[0] == NONE:
        return p
    for _ in range(WALL_ITERATIONS):
        p = _clamp(place_beside(scene, half[0], half[1], p, grid.radius), low, high)
    return place_beside(scene, half[0], half[1], p, grid.clearance)


def _reach_other_end(memory: Memory, grid: SearchGrid, scene: Scene, which: int, cell: int, key: int) -> None:
    """Note of a cell, if it is so, that it reaches to where routes of the other side begin."""
    aim, close = _end_ball(grid, 1 - which)
    low, high = corners(grid, key)
    half = 0.5 * grid.cell  # it is the middles of the finest cells that count
    p = _clamp(aim, (low[0] + half, low[1] + half, low[2] + half), (high[0] - half, high[1] - half, high[2] - half))
    rest, cut = norm(sub(p, aim)), memory.table.cuts[cell >> 3]
    if rest <= close and (cut == NONE or distance_beyond(scene, cut, cell & 7, aim) + close >= grid.clearance):
        _begin_in_cell(pick(memory.sides, 1 - which), cell, rest, p)


push_here = inline(push_cell)


def _reach_cell(memory: Memory, grid: SearchGrid, scene: Scene, here: Here, new: int, key: int, met: int) -> int:
    """See whether the route to the cell `new` is cheaper from here; returns the cell of the cheapest route so far."""
    table, side, other = memory.table, pick(memory.sides, here.which), pick(memory.sides, 1 - here.which)
    cut = table.cuts[new >> 3]
    if side.done[new] != 0:
        return met
    if (cut != NONE or here.cut != NONE) and not linked(
        grid, scene, (here.key, here.cut, here.cell & 7), (key, cut, new & 7)
    ):
        return met
    aim, close = _end_ball(grid, 1 - here.which)
    d = table.distance[new]
    there = _entry_point(grid, scene, here, key, (cut, new & 7), aim)
    step = norm(sub(there, here.point))
    cost = side.cost[here.cell] + 0.5 * step * (here.rate + cost_rate(grid, d) + DETOUR * table.penalized[new])
    length = side.length[here.cell] + step
    rest = norm(sub(there, aim))
    if cost >= side.cost[new] or SMOOTHED * length + rest > grid.longest:
        return met
    if here.level == 0 and numbers_of(key)[0] == 0 and d + table.distance[here.cell] < step:
        spend(memory.clock, work_of_all(scene))
        if has_wall(grid, scene, here.key, key):
            return met
    side.cost[new], side.length[new], side.before[new] = cost, length, here.cell
    put_vec(side.points, new, 0, there)
    push_here(memory, here.which, cost + grid.inflation * rest, new)
    if rest <= close + 2.0 * HALF_DIAGONAL * grid.cell * (1 << numbers_of(key)[0]):
        _reach_other_end(memory, grid, scene, here.which, new, key)
    return new if other.cost[new] < math.inf and _joins_cheaper(memory, grid, new, met) else met


def _reach_into(memory: Memory, grid: SearchGrid, scene: Scene, here: Here, divided: int, met: int) -> int:
    """The same for all cells that can be passed in a larger one, `divided`, and touch the one here."""
    table, stack = memory.table, memory.stack
    stack[0], count = divided, 1
    while count > 0:
        count -= 1
        key = stack[count]
        block = block_of(table, key)
        if block == NONE:
            block = add_block(memory, key, NONE)
        if block == NONE:
            return met
        if table.cuts[block] != NONE:
            for half in range(2):
                met = _reach_cell(memory, grid, scene, here, 8 * block + half, key, met)
            continue
        for octant in range(8):
            child = child_of(key, octant)
            if table.distance[8 * block + octant] == BLOCKED or not touch(child, here.key):
                continue
            d = evaluate_cell(memory, grid, scene, child, 8 * block + octant)
            if d == DIVIDED:
                stack[count] = child
                count += 1
            elif d > DIVIDED:
                met = _reach_cell(memory, grid, scene, here, 8 * block + octant, child, met)
    return met


block_of_here, reach_here = inline(block_of), inline(_reach_cell)


def _reach_halves(memory: Memory, grid: SearchGrid, scene: Scene, here: Here, block: int, met: int) -> int:
    """The same for both halves of a cell that a wall cuts."""
    cost = memory.sides.cost
    for half in range(8 * block, 8 * block + 2):
        if cost[here.which, half] > cost[here.which, here.cell]:
            met = _reach_cell(memory, grid, scene, here, half, memory.table.parents[block], met)
    return met


def _reach_block(memory: Memory, grid: SearchGrid, scene: Scene, here: Here, block: int, met: int) -> int:
    """The same for those of the eight cells of a block that touch the one here, which is as large as they are."""
    table, cost = memory.table, memory.sides.cost[here.which]
    level, x, y, z = numbers_of(here.key)
    _, i, j, k = numbers_of(table.parents[block])
    for u in range(max(2 * i, x - 1), min(2 * i + 1, x + 1) + 1):
        for v in range(max(2 * j, y - 1), min(2 * j + 1, y + 1) + 1):
            for w in range(max(2 * k, z - 1), min(2 * k + 1, z + 1) + 1):
                new, key = 8 * block + octant_of(u, v, w), key_of(level, u, v, w)
                d = table.distance[new]
                if d == BLOCKED or cost[new] <= cost[here.cell]:  # nothing is reached from here that costs no more
                    continue
                if d == UNKNOWN:
                    d = evaluate_cell(memory, grid, scene, key, new)
                if d > DIVIDED:
                    met = reach_here(memory, grid, scene, here, new, key, met)
                elif d == DIVIDED:
                    met = _reach_into(memory, grid, scene, here, key, met)
    return met


reach_block_here = inline(_reach_block)


def _examine_neighbours(memory: Memory, grid: SearchGrid, scene: Scene, which: int, cell: int, met: int) -> int:
    """Examine the neighbours of a cell; returns the cell that the cheapest route known so far leads through."""
    table, side = memory.table, pick(memory.sides, which)
    key = key_in(table, cell)
    level, x, y, z = numbers_of(key)
    own = cost_rate(grid, table.distance[cell]) + DETOUR * table.penalized[cell]
    here = Here(which, cell, key, table.cuts[cell >> 3], level, get_vec(side.points, cell, 0), own)
    for i in range((x - 1) >> 1, ((x + 1) >> 1) + 1):
        for j in range((y - 1) >> 1, ((y + 1) >> 1) + 1):
            for k in range((z - 1) >> 1, ((z + 1) >> 1) + 1):
                parent = key_of(level + 1, i, j, k)
                block = block_of_here(table, parent)
                if block == NONE:
                    block = block_at(memory, grid, scene, parent)
                if block <= LEAF:
                    new = LEAF - block
                    if side.cost[new] > side.cost[cell]:
                        met = _reach_cell(memory, grid, scene, here, new, key_in(table, new), met)
                elif block != NONE and table.cuts[block] != NONE:
                    met = _reach_halves(memory, grid, scene, here, block, met)
                elif block != NONE:
                    met = reach_block_here(memory, grid, scene, here, block, met)
    return met


def _least_priority(side: Side) -> float:
    """Least priority of a side; infinite when it is dry."""
    return side.priority[0] if side.size[0] > 0 else math.inf


def search_from_both_ends(memory: Memory, grid: SearchGrid, scene: Scene) -> tuple[int, int]:
    """Search from the cells about the goal and from those about the start; what was searched before is in the memory.

    Returns FOUND, CLOSED (no route), FULL (the table or a heap is) or TIMED_OUT; and the cell in which both sides met
    (NONE: there is no route). From there `before` of each side leads to its end.
    """
    table, sides = memory.table, memory.sides
    goal_side, start_side = pick(sides, FROM_GOAL), pick(sides, FROM_START)
    from_goal = _open_ends(memory, grid, scene, FROM_GOAL)
    from_start = _open_ends(memory, grid, scene, FROM_START)
    if not from_goal and not from_start:
        return FULL, NONE
    met = NONE
    for cell in range(8 * table.size[BLOCKS]):
        if _joins_cheaper(memory, grid, cell, met):
            met = cell
    while True:
        if spend(memory.clock, CELL_WORK):
            return TIMED_OUT, NONE
        if table.size[OVERFLOW] != 0:
            return FULL, NONE
        least_from_goal = _least_priority(goal_side) if from_goal else 0.0
        least_from_start = _least_priority(start_side) if from_start else 0.0
        if met != NONE and _cost_through(memory, grid, met) <= max(least_from_goal, least_from_start):
            return FOUND, met
        if max(least_from_goal, least_from_start) == math.inf:
            return CLOSED, NONE
        fewer = start_side.size[0] < goal_side.size[0]
        which = FROM_START if from_start and (fewer or not from_goal) else FROM_GOAL
        side = pick(sides, which)
        cell = pop_cell(side)
        if side.done[cell] != 0:
            continue
        side.done[cell] = 1
        if sides.done[1 - which, cell] != 0 and met != NONE:
            return FOUND, met
        met = _examine_neighbours(memory, grid, scene, which, cell, met)


def penalize_route(memory: Memory, grid: SearchGrid, scene: Scene, met: int) -> None:
    """Make the route through the cell `met`, and cells beside it, dearer; about large ones only those that touch."""
    table = memory.table
    for which in range(2):
        cell = met
        while cell != NONE:
            level, x, y, z = numbers_of(key_in(table, cell))
            reach = PENALIZED_CELLS if level == 0 else 1
            for i in range(-reach, reach + 1):
                for j in range(-reach, reach + 1):
                    for k in range(-reach, reach + 1):
                        near = known_leaf(memory, grid, scene, key_of(level, x + i, y + j, z + k))
                        if near != NONE:
                            table.penalized[near] = 1
            cell = int(memory.sides.before[which, cell])
