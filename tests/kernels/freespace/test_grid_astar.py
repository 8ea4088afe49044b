"""Routes over the cells of a grid, against SciPy's shortest paths on the whole of it; and closed rooms."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.kernels.freespace import grid_astar
from sinuous.kernels.freespace.cells import Memory
from sinuous.kernels.freespace.grid import FINEST_STEP, HALF_DIAGONAL, SearchGrid
from sinuous.kernels.tables import CLOSED, FOUND
from tests.helpers import Floats, kernel_scene
from tests.kernels.freespace.places import CELL, GOAL, RADIUS, REACH, grid, memory, spheres


def explore(work: Memory, where: SearchGrid, scene: sn.Scene) -> tuple[int, int]:
    found: tuple[int, int] = grid_astar.search_from_both_ends(work, where, kernel_scene(scene))
    return found


def trace(work: Memory, where: SearchGrid, met: int) -> Floats:
    """Middles of the cells of a route, from the start on."""
    halves = []
    for which in (grid_astar.FROM_START, grid_astar.FROM_GOAL):
        cell, points = met, []
        while cell >= 0:
            points.append(work.sides.points[which, cell].copy())
            cell = int(work.sides.before[which, cell])
        halves.append(points)
    return np.array(halves[0][::-1] + halves[1])


def cost(work: Memory, met: int) -> float:
    return float(work.sides.cost[:, met].sum()) if met >= 0 else math.inf


def walled(where: SearchGrid, scene: sn.Scene, a: Floats, b: Floats) -> Any:
    """Whether walls are met on lines (m, 3) from one end to the other, with steps as long as the distance from them."""
    lengths = np.linalg.norm(b - a, axis=-1)
    gone, found = np.zeros(len(a)), np.zeros(len(a), bool)
    going = gone < lengths
    while going.any():
        share = (gone[going] / lengths[going])[:, None]
        d = scene.distance(a[going] + share * (b[going] - a[going]))
        found[going] = d < where.clearance
        gone[going] += np.maximum(d - where.clearance, FINEST_STEP * lengths[going])
        going = ~found & (gone < lengths)
    return found


def within_reach(middles: Floats, reach: float, cell: float = CELL) -> Any:
    """Where a route of that length from the origin to the goal can lead through."""
    length = np.linalg.norm(middles, axis=-1) + np.linalg.norm(middles - GOAL, axis=-1)
    return length <= reach + 2.0 * HALF_DIAGONAL * cell


def prices(where: SearchGrid, d: Floats) -> Floats:
    """What a unit of length costs: 1 in the open, more within `room`, and steeply more where the body overlaps."""
    free = d - where.radius
    beside = 1.0 + where.clearance_weight * 2.0 * (1.0 - free / where.free_margin)
    overlapping = 1.0 + where.clearance_weight * (2.0 - 20.0 * free / where.cell)
    return np.select([free >= where.free_margin, free >= 0.0], [np.ones_like(d), beside], overlapping)


def whole_grid(where: SearchGrid, scene: sn.Scene) -> tuple[Floats, Floats, Any, Any, Floats]:
    """Middles and distances (-inf: cannot be passed) of all cells within reach; edges from and to cells, and costs."""
    most = math.ceil(REACH / where.cell) + 1
    axis = np.arange(-most, most + 1, dtype=np.float64)
    index = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    middles: Floats = where.cell * index
    d = scene.distance(middles)
    d[(d < where.clearance) | ~within_reach(middles, REACH, where.cell)] = -np.inf
    price = prices(where, d)
    side = len(axis)
    numbers = np.arange(side**3).reshape(side, side, side)
    rows, columns, costs = [], [], []
    for step in np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1], [-1, 0, 1], indexing="ij"), axis=-1).reshape(-1, 3):
        here = tuple(slice(max(0, -s), side - max(0, s)) for s in step)
        there = tuple(slice(max(0, s), side - max(0, -s)) for s in step)
        a, b = numbers[here].ravel(), numbers[there].ravel()
        length = where.cell * np.linalg.norm(step)
        keep = (d[a] > -np.inf) & (d[b] > -np.inf) & (length > 0.0)
        a, b = a[keep], b[keep]
        asked = d[a] + d[b] < length
        open_edge = np.ones(len(a), bool)
        open_edge[asked] = ~walled(where, scene, middles[a[asked]], middles[b[asked]])
        a, b = a[open_edge], b[open_edge]
        rows.append(a)
        columns.append(b)
        costs.append(0.5 * length * (price[a] + price[b]))
    return middles, d, np.concatenate(rows), np.concatenate(columns), np.concatenate(costs)


def least_cost(where: SearchGrid, scene: sn.Scene) -> float:
    """Cost of the cheapest route, by Dijkstra's search from one more place, beside the cells about the goal."""
    middles, d, rows, columns, costs = whole_grid(where, scene)
    off = np.linalg.norm(middles - GOAL, axis=1)
    seeds = np.flatnonzero((off <= HALF_DIAGONAL * CELL) & (d > -np.inf))
    count = len(middles)
    entries = (np.append(rows, np.full(len(seeds), count)), np.append(columns, seeds))
    edges: Any = coo_array((np.append(costs, off[seeds]), entries), shape=(count + 1, count + 1)).tocsr()
    search: Any = dijkstra
    return float(search(edges, indices=count)[np.linalg.norm(middles, axis=1).argmin()])


@pytest.mark.parametrize("inflation", [1.0, 2.0])
@pytest.mark.parametrize("seed", range(6))
def test_a_route_costs_little_more_than_the_cheapest(seed: int, inflation: float) -> None:
    scene, where, work = spheres(seed), grid(inflation=inflation), memory()
    ended, met = explore(work, where, scene)
    least = least_cost(where, scene)
    assert ended == (FOUND if np.isfinite(least) else CLOSED)
    assert least * (1 - 1e-12) <= cost(work, met)
    assert cost(work, met) <= inflation * (2.0 * least - np.linalg.norm(GOAL)) * (1 + 1e-12)


def world(seed: int) -> sn.Scene:
    """A closed room about the goal or the start, with a door or without, askew, and some more boxes and balls."""
    rng = np.random.default_rng(seed)
    turn = Rotation.from_rotvec(rng.normal(size=3) * rng.integers(0, 2)).as_matrix()
    middle = np.array(GOAL) if seed % 2 else np.zeros(3)
    half, wall, found = rng.uniform(0.45, 0.8, 3), rng.uniform(0.05, 0.2), []
    for axis in range(3):
        for side in (-1.0, 1.0):
            center, size = np.zeros(3), 2.0 * half + 2.0 * wall
            center[axis], size[axis] = side * (half[axis] + 0.5 * wall), wall
            if (axis, side) == (seed % 3, 1.0):  # a slit at one end of it, perhaps wide enough
                slit = rng.uniform(0.0, 4.0 * RADIUS)
                size[axis - 1] -= slit
                center[axis - 1] -= 0.5 * slit
            found.append(sn.Box(middle + turn @ center, size, turn))
    for _ in range(rng.integers(0, 5)):
        turn = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
        found.append(sn.Box(rng.uniform(-1.0, 1.5, 3), rng.uniform(0.05, 1.5, 3), turn))
    return sn.Scene([*found, sn.Sphere((*rng.uniform(-0.9, 1.4, 2), 0.9), 0.1)])


HALVED = 0.5 * RADIUS


def is_joined(where: SearchGrid, scene: sn.Scene) -> bool:
    """Whether the finest cells about the start and those about the goal hang together, by all cells of the grid."""
    middles, d, rows, columns, costs = whole_grid(where, scene)
    edges: Any = coo_array((costs, (rows, columns)), shape=(len(middles),) * 2).tocsr()
    parts = connected_components(edges, directed=False)[1]
    free = d > -np.inf
    at_start = parts[free & (np.linalg.norm(middles - where.start, axis=1) <= where.start_radius)]
    goal_radius = where.goal_radius + HALF_DIAGONAL * where.cell
    at_goal = parts[free & (np.linalg.norm(middles - where.goal, axis=1) <= goal_radius)]
    return len(np.intersect1d(at_start, at_goal)) > 0


@cache
def is_world_joined(seed: int) -> bool:
    """The same of a world, whatever the sizes of cells that are searched."""
    return is_joined(of_sizes(1), world(seed))


def of_sizes(levels: int, **changed: Any) -> SearchGrid:
    clearance = RADIUS - HALF_DIAGONAL * HALVED
    changed = {"cell": HALVED, "start_radius": HALVED, "clearance": clearance, "inflation": 2.0} | changed
    return grid(levels=levels, **changed)


@pytest.mark.parametrize("levels", [1, 3, 5])
@pytest.mark.parametrize("seed", range(8))
def test_cells_of_all_sizes_lead_as_far_as_the_finest(seed: int, levels: int) -> None:
    scene, where = world(seed), of_sizes(levels)
    ended, met = explore(memory(1 << 16), where._replace(inflation=1e6, clearance_weight=0.0), scene)
    assert ended == (FOUND if is_world_joined(seed) else CLOSED)
    assert (met >= 0) == (ended == FOUND)


@pytest.mark.parametrize("seed", range(8))
def test_a_route_by_cells_of_all_sizes_is_clear_and_not_dear(seed: int) -> None:
    scene, where, work = world(seed), of_sizes(4)._replace(ample=RADIUS), memory(1 << 16)
    ended, met = explore(work, where, scene)
    if ended != FOUND:
        return
    route = trace(work, where, met)
    steps = np.linspace(0.0, 1.0, 20)[:, None, None]
    along = route[:-1] + steps * np.diff(route, axis=0)
    assert scene.distance(along).min() > where.clearance - HALF_DIAGONAL * where.cell
    plain = explore(finest := memory(1 << 16), of_sizes(0), scene)[1]
    assert cost(work, met) <= 2.0 * cost(finest, plain)
