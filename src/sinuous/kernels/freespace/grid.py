"""The grid of one search: where its cells are, which can be passed, and what that costs."""

import math
from collections import namedtuple

from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import Scene, closest
from sinuous.kernels.freespace.cells import key_of, numbers_of
from sinuous.kernels.maths.vectors import Vec, add_scaled, dot, norm, sub

HALF_DIAGONAL = 0.5 * math.sqrt(3.0)
"""Of a cell, in units of its edge."""

FINEST = 0.1
"""Shortest step in the search for a wall between two cells, in units of the distance between them."""

Grid = namedtuple(
    "Grid",
    [
        "origin",
        "cell",
        "clearance",
        "radius",
        "room",
        "reach",
        "start",
        "start_radius",
        "axis",
        "goal",
        "goal_radius",
        "back",
        "turn",
        "inflation",
        "clearance_weight",
        "longest",
        "mode",
    ],
)
"""What one search is about; lengths in the length unit.

`origin` is the middle of the cell (0, 0, 0), `cell` the edge of the cells. `clearance` is the distance from obstacles
with which a cell can be passed, `radius` that of the body, `room` the distance beyond it that costs nothing. Routes run
from within `start_radius` of `start`, where they leave along the unit vector `axis`, to within `goal_radius` of `goal`,
where the unit vector `back` points to where they come from (zero: from anywhere); within `turn` of both nothing passes
behind them. From `origin` to `goal` no route is longer than `reach`, from `start` to `goal` none than `longest`. The
search is a weighted A*: with `inflation` 1 the cheapest route is found; with more, one that costs at most so many times
as much, after fewer cells. `clearance_weight` says how much dearer narrow places are. Distances are asked
for in a mode of `solids`; a proof asks for upper bounds, because what can be passed must not be taken for a wall."""


@kernel
def middle(grid: Grid, key: int) -> Vec:
    """Middle of the cell `key`."""
    x, y, z = numbers_of(key)
    o, h = grid.origin, grid.cell
    return o[0] + h * x, o[1] + h * y, o[2] + h * z


@kernel
def cell_at(grid: Grid, p: Vec) -> int:
    """Key of the cell that the point `p` lies in."""
    o, h = grid.origin, grid.cell
    return key_of(
        math.floor((p[0] - o[0]) / h + 0.5), math.floor((p[1] - o[1]) / h + 0.5), math.floor((p[2] - o[2]) / h + 0.5)
    )


@kernel
def _behind(grid: Grid, p: Vec, place: Vec, axis: Vec) -> bool:
    """Whether `p` is behind `place`, and so near that a route cannot leave along `axis` and turn there."""
    away = sub(p, place)
    return dot(away, axis) < -grid.cell and dot(away, away) < grid.turn * grid.turn


@kernel
def free_distance(grid: Grid, scene: Scene, p: Vec) -> float:
    """Distance of the middle `p` of a cell to the obstacles; -inf where the cell cannot be passed."""
    h = grid.cell
    # A route of bounded length from one place to another stays within an ellipsoid about both.
    far = norm(sub(p, grid.origin)) + max(0.0, norm(sub(p, grid.goal)) - grid.goal_radius)
    if far > grid.reach + 2.0 * HALF_DIAGONAL * h:
        return -math.inf
    d, _ = closest(scene, p, max(grid.radius + grid.room, 2.0 * h), grid.mode)
    barred = _behind(grid, p, grid.start, grid.axis) or _behind(grid, p, grid.goal, grid.back)
    return -math.inf if barred or d < grid.clearance else d


@kernel
def walled(grid: Grid, scene: Scene, one: int, other: int) -> bool:
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
        gone += max(d - grid.clearance, FINEST * length)
    return False


@kernel
def price(grid: Grid, distance: float) -> float:
    """What a unit of length costs at this distance from the obstacles."""
    clear_by = distance - grid.radius
    if clear_by >= grid.room:
        return 1.0
    if clear_by >= 0.0:
        return 1.0 + 2.0 * grid.clearance_weight * (1.0 - clear_by / grid.room)
    return 1.0 + grid.clearance_weight * (2.0 - 20.0 * clear_by / grid.cell)
