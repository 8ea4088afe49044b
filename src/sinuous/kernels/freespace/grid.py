"""The grid of one search: where its cells are, which can be passed, and what that costs."""

import math
from collections import namedtuple

from sinuous.kernels.fields.distances import Scene, closest
from sinuous.kernels.freespace.keys import key_of, numbers_of
from sinuous.kernels.maths.vectors import Vec, add_scaled, dot, norm, sub

HALF_DIAGONAL = 0.5 * math.sqrt(3.0)
"""Of a cell, in units of its edge."""

FINEST_STEP = 0.1
"""Shortest step in the search for a wall between two cells, in units of the distance between them."""

SearchGrid = namedtuple(
    "SearchGrid",
    "origin cell levels clearance ample radius free_margin reach start start_radius goal goal_radius inflation "
    "clearance_weight longest mode normal",
)
"""What one search is about; lengths in the length unit.

`origin` is the middle of the finest cell (0, 0, 0), `cell` the edge of these, and there are `levels` larger sizes.
`clearance` is the distance from obstacles with which one of the finest can be passed, `ample` that of all that are
joined to a larger one; `radius` is that of the body, `free_margin` the distance beyond it that costs nothing. Routes
run from within `start_radius` of `start` to within `goal_radius` of `goal`. From `origin` to `goal` none is longer than
`reach`, from `start` to `goal` none than `longest`. The search is a weighted A*: with `inflation` 1 the cheapest route
is found; with more, one that costs at most so many times as much, after fewer cells. `clearance_weight` says how much
dearer narrow places are. Distances are asked for in a mode of `solids`; a proof asks for upper bounds: what can be
passed must not be taken for a wall. Routes stay in the plane with this `normal` through `origin` (zero: anywhere)."""


def middle(grid: SearchGrid, key: int) -> Vec:
    """Middle of the cell `key`."""
    level, x, y, z = numbers_of(key)
    size = float(1 << level)
    o, h, first = grid.origin, grid.cell * size, 0.5 * grid.cell * (size - 1.0)
    return o[0] + h * x + first, o[1] + h * y + first, o[2] + h * z + first


def corners(grid: SearchGrid, key: int) -> tuple[Vec, Vec]:
    """Low and high corner of the cell `key`."""
    level, _, _, _ = numbers_of(key)
    p, r = middle(grid, key), 0.5 * grid.cell * (1 << level)
    return (p[0] - r, p[1] - r, p[2] - r), (p[0] + r, p[1] + r, p[2] + r)


def onto_plane(grid: SearchGrid, p: Vec) -> Vec:
    """The place nearest to the point `p` in the plane that routes stay in, if they do."""
    return add_scaled(p, -dot(sub(p, grid.origin), grid.normal), grid.normal)


def cell_at(grid: SearchGrid, p: Vec) -> int:
    """Key of the finest cell that the point `p` lies in."""
    o, h = grid.origin, grid.cell
    x, y, z = math.floor((p[0] - o[0]) / h + 0.5), math.floor((p[1] - o[1]) / h + 0.5), (p[2] - o[2]) / h + 0.5
    return key_of(0, x, y, math.floor(z))


def has_wall(grid: SearchGrid, scene: Scene, one: int, other: int) -> bool:
    """Whether a wall stands between two neighbours; to be asked where their own distances leave room for one.

    On the line from one middle to the other, steps are as long as the distance from what cannot be passed.
    """
    a, b = middle(grid, one), middle(grid, other)
    line = sub(b, a)
    length = norm(line)
    gone = 0.0
    while gone < length:
        d, _ = closest(scene, add_scaled(a, gone / length, line), 2.0 * length, grid.mode)
        if d < grid.clearance:
            return True
        gone += max(d - grid.clearance, FINEST_STEP * length)
    return False


def cost_rate(grid: SearchGrid, distance: float) -> float:
    """What a unit of length costs at this distance from the obstacles."""
    clear_by = distance - grid.radius
    if clear_by >= grid.free_margin:
        return 1.0
    if clear_by >= 0.0:
        return 1.0 + 2.0 * grid.clearance_weight * (1.0 - clear_by / grid.free_margin)
    return 1.0 + grid.clearance_weight * (2.0 - 20.0 * clear_by / grid.cell)
