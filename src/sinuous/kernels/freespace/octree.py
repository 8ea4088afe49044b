"""Free space in cells of several sizes: as large as the distance to the obstacles allows, the finest beside them.

The grid of the finest cells is what is searched: one of them can be passed when its middle is no nearer than
`clearance` to any obstacle. A larger cell stands for all of the finest in it where the distance of its own middle says
enough of theirs, because distance changes by at most the distance moved: either all can be passed, with no wall between
them or to those beside them, or none. Every other cell is divided into eight. So what can be reached is the same as by
the finest cells alone, at a price that goes by the surface of free space, not by its volume.
"""

from sinuous.kernels.clock import spend
from sinuous.kernels.compile import inline
from sinuous.kernels.fields.distances import Scene, closest, work_of_all
from sinuous.kernels.freespace.cells import BLOCKED, DIVIDED, EVALUATED, NONE, UNKNOWN, Memory, add_block, block_of
from sinuous.kernels.freespace.cut_cells import distance_beyond, find_cut, side_of
from sinuous.kernels.freespace.grid import HALF_DIAGONAL, SearchGrid, middle
from sinuous.kernels.freespace.keys import child_of, numbers_of, octant_of, parent_of
from sinuous.kernels.maths.vectors import dot, norm, sub

ROUND = 64.0
"""Cells that lie partly out of reach are divided where they are larger than the reach divided by this."""

LEAF = -2
"""What `block_at` returns for a cell that is not divided, less its number."""


def classify_cell(grid: SearchGrid, scene: Scene, key: int) -> tuple[float, int]:
    """Distance of the middle of a cell to the obstacles, if all of it can be passed; BLOCKED, or DIVIDED.

    And what cuts it in two, see `cut_cells`; NONE where it is divided into eight, or not at all.
    """
    level, _, _, _ = numbers_of(key)
    p, h = middle(grid, key), grid.cell
    edge = h * (1 << level)
    spread = HALF_DIAGONAL * (edge - h)  # farthest middle of a finest cell in it
    n, from_origin = grid.normal, sub(p, grid.origin)
    if 2.0 * abs(dot(from_origin, n)) > edge * (abs(n[0]) + abs(n[1]) + abs(n[2])):  # the plane does not meet it
        return BLOCKED, NONE
    # A route of bounded length from one place to another stays within an ellipsoid about both.
    far = norm(from_origin) + max(0.0, norm(sub(p, grid.goal)) - grid.goal_radius)
    far -= grid.reach + 2.0 * HALF_DIAGONAL * h
    if far > 2.0 * spread:
        return BLOCKED, NONE
    if far > -2.0 * spread and level > 0 and ROUND * edge > grid.reach:
        return DIVIDED, NONE
    enough = spread + grid.ample
    d, which = closest(scene, p, max(grid.radius + grid.free_margin, enough, 2.0 * h), grid.mode)
    if d < grid.clearance - spread:
        return BLOCKED, NONE
    if level == 0 or d >= enough:
        return d, NONE
    return DIVIDED, find_cut(grid, scene, p, edge, which)


def _halve_cell(memory: Memory, grid: SearchGrid, key: int, cut: int) -> None:
    """Give a cell two halves; in the open, for there is room in them."""
    block = add_block(memory, key, cut)
    if block != NONE:
        for side in range(2):
            memory.table.distance[8 * block + side] = grid.radius + grid.free_margin


def evaluate_cell(memory: Memory, grid: SearchGrid, scene: Scene, key: int, cell: int) -> float:
    """Distance of a cell as the table has it; a cell that nobody examined is examined now."""
    table = memory.table
    if table.distance[cell] == UNKNOWN:
        table.distance[cell], cut = classify_cell(grid, scene, key)
        table.size[EVALUATED] += 1
        if cut != NONE:
            _halve_cell(memory, grid, key, cut)
        spend(memory.clock, work_of_all(scene))
    return float(table.distance[cell])


block_of_here = inline(block_of)


def block_at(memory: Memory, grid: SearchGrid, scene: Scene, key: int) -> int:
    """Number of the block of a cell, which is examined, and given one, if need be; or of one that it lies in half of.

    Returns NONE where the cell cannot be passed or has no place in the table; where it is not divided because it, or a
    larger cell that it lies in, can be passed as a whole, LEAF less the number of that.
    """
    block = block_of_here(memory.table, key)
    if block != NONE:
        return block
    top = grid.levels + 1
    up, level = key, numbers_of(key)[0]
    at = level
    while block == NONE and at < top:
        up, at = parent_of(up), at + 1
        block = block_of_here(memory.table, up)
    if block == NONE:
        block = add_block(memory, up, NONE)
    _, x, y, z = numbers_of(key)
    while at > level and block != NONE and memory.table.cuts[block] == NONE:
        at -= 1
        by = at - level
        octant = octant_of(x >> by, y >> by, z >> by)
        cell, up = 8 * block + octant, child_of(up, octant)
        d = evaluate_cell(memory, grid, scene, up, cell)
        if d == BLOCKED:
            return NONE
        if d > DIVIDED:
            return LEAF - cell
        block = block_of(memory.table, up)
        if block == NONE:
            block = add_block(memory, up, NONE)
    return block


def leaf_at(memory: Memory, grid: SearchGrid, scene: Scene, key: int) -> int:
    """Number of the cell that can be passed as a whole and in which the finest cell `key` lies; NONE without one."""
    block = block_at(memory, grid, scene, parent_of(key))
    if block <= LEAF:
        return LEAF - block
    if block == NONE:
        return NONE
    cut = memory.table.cuts[block]
    if cut != NONE:
        side = side_of(scene, cut, middle(grid, key))
        return 8 * block + side if distance_beyond(scene, cut, side, middle(grid, key)) >= grid.clearance else NONE
    _, x, y, z = numbers_of(key)
    cell = 8 * block + octant_of(x, y, z)
    return cell if evaluate_cell(memory, grid, scene, key, cell) > DIVIDED else NONE


def known_leaf(memory: Memory, grid: SearchGrid, scene: Scene, key: int) -> int:
    """Number of the cell that was examined, can be passed as a whole, and in which `key` lies; NONE without one."""
    table = memory.table
    up, at = key, numbers_of(key)[0]
    while at <= grid.levels:
        parent = parent_of(up)
        block = block_of(table, parent)
        if block != NONE:
            if table.cuts[block] != NONE:
                return 8 * block + side_of(scene, table.cuts[block], middle(grid, key))
            _, x, y, z = numbers_of(up)
            cell = 8 * block + octant_of(x, y, z)
            return cell if table.distance[cell] > DIVIDED else NONE
        up, at = parent, at + 1
    return NONE
