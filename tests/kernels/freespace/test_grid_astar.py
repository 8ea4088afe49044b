"""Ways through a lattice of cubes, against SciPy's shortest paths on the whole of it; and closed rooms."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import label
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from sinuous.kernels.fields.solids import EXACT
from sinuous.kernels.freespace import grid_astar as lattice
from sinuous.kernels.freespace.grid_astar import (
    CLOSED,
    FOUND,
    FULL,
    HALF_DIAGONAL,
    LATE,
    Corridor,
    Lattice,
    lattice_size,
)
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_scene

CELL, RADIUS, REACH = 0.2, 0.25, 1.8


def empty_lattice(slots: int = 1 << 15) -> Lattice:
    heap = lattice.HEAP_SHARE * slots
    assert lattice_size(slots) == 7 * slots + 2 * heap
    return Lattice(
        np.zeros(slots, np.int64),
        np.zeros(slots, np.int64),
        np.zeros(slots),
        np.zeros(slots),
        np.zeros(slots),
        np.zeros(slots),
        np.zeros(slots),
        np.zeros(heap),
        np.zeros(heap, np.int64),
    )


def corridor(**changed: Any) -> Corridor:
    values: dict[str, Any] = {
        "origin": (0.0, 0.0, 0.0),
        "cell": CELL,
        "least": RADIUS - HALF_DIAGONAL * CELL,
        "radius": RADIUS,
        "room": 0.3,
        "reach": REACH,
        "start": (0.0, 0.0, 0.0),
        "axis": (0.0, 0.0, 0.0),
        "goal": (0.8, 0.4, 0.6),
        "back": (0.0, 0.0, 0.0),
        "turn": 0.0,
        "around": 0.0,
        "close": 0.5 * CELL,
        "haste": 1.0,
        "care": 1.0,
        "longest": math.inf,
        "how": EXACT,
    }
    return Corridor(**(values | changed))


def explore(table: Lattice, where: Corridor, scene: Scene, deadline: float = math.inf) -> tuple[int, int, int]:
    found: tuple[int, int, int] = lattice.explore(table, where, kernel_scene(scene), np.zeros(2, np.int64), deadline, 0)
    return found


def spheres(seed: int) -> Scene:
    rng = np.random.default_rng(seed)
    found: list[Sphere] = []
    while len(found) < 12:
        center, radius = rng.uniform(-1.0, 1.0, 3), rng.uniform(0.1, 0.3)
        if min(np.linalg.norm(center), np.linalg.norm(center - [0.8, 0.4, 0.6])) > radius + RADIUS + 0.05:
            found.append(Sphere(center, radius))
    return Scene(found)


def walled(where: Corridor, scene: Scene, a: Floats, b: Floats) -> bool:
    """Whether a wall is met on the way from one to the other, with steps as long as the distance from it."""
    way = float(np.linalg.norm(b - a))
    gone = 0.0
    while gone < way:
        d = float(scene.distance(a + gone / way * (b - a)))
        if d < where.least:
            return True
        gone += max(d - where.least, lattice.FINEST * way)
    return False


def within_reach(middles: Floats, reach: float) -> Any:
    """Where a way of that length from the origin to the goal can lead through."""
    goal = np.array(corridor().goal)
    way = np.linalg.norm(middles, axis=-1) + np.linalg.norm(middles - goal, axis=-1)
    return way <= reach + 2.0 * HALF_DIAGONAL * CELL


def whole_lattice(where: Corridor, scene: Scene) -> tuple[Floats, Floats, Any]:
    """Middles of all cubes within reach, their distances (-inf: cannot be passed), and the edges with their costs."""
    most = math.ceil(REACH / CELL) + 1
    axis = np.arange(-most, most + 1, dtype=np.float64)
    index = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    middles: Floats = CELL * index
    d = scene.distance(middles)
    d[(d < where.least) | ~within_reach(middles, REACH)] = -np.inf
    prices = np.array([lattice.price(where, x) if x > -np.inf else np.inf for x in d])
    side = len(axis)
    numbers = np.arange(side**3).reshape(side, side, side)
    rows, columns, costs = [], [], []
    for step in np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1], [-1, 0, 1], indexing="ij"), axis=-1).reshape(-1, 3):
        here = tuple(slice(max(0, -s), side - max(0, s)) for s in step)
        there = tuple(slice(max(0, s), side - max(0, -s)) for s in step)
        a, b = numbers[here].ravel(), numbers[there].ravel()
        way = CELL * np.linalg.norm(step)
        free = (d[a] > -np.inf) & (d[b] > -np.inf) & (way > 0.0)
        wall = d[a] + d[b] < way
        wall[wall] = [walled(where, scene, middles[i], middles[j]) for i, j in zip(a[wall], b[wall], strict=True)]
        keep = free & ~wall
        rows.append(a[keep])
        columns.append(b[keep])
        costs.append(0.5 * way * (prices[a] + prices[b])[keep])
    entries = (np.concatenate(rows), np.concatenate(columns))
    edges: Any = coo_array((np.concatenate(costs), entries), shape=(side**3, side**3)).tocsr()
    return middles, d, edges


@pytest.mark.parametrize("seed", range(6))
def test_the_way_is_a_shortest_one(seed: int) -> None:
    scene, where = spheres(seed), corridor()
    table = empty_lattice()
    ended, slot, _ = explore(table, where, scene)
    middles, d, edges = whole_lattice(where, scene)
    goal = np.array(where.goal)
    seeds = np.flatnonzero((np.linalg.norm(middles - goal, axis=1) <= HALF_DIAGONAL * CELL) & (d > -np.inf))
    ways = dijkstra(edges, indices=seeds) + np.linalg.norm(middles[seeds] - goal, axis=1)[:, None]
    least = ways.min(axis=0)[np.linalg.norm(middles, axis=1).argmin()]
    assert ended == (FOUND if np.isfinite(least) else CLOSED)
    assert table.cost[slot] == pytest.approx(least, rel=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_haste_costs_no_more_than_it_says(seed: int) -> None:
    scene, table, hasty = spheres(seed), empty_lattice(), empty_lattice()
    _, slot, cubes = explore(table, corridor(), scene)
    _, other, fewer = explore(hasty, corridor(haste=2.0), scene)
    assert hasty.cost[other] <= 2.0 * table.cost[slot] + 1e-12
    assert fewer <= cubes


@pytest.mark.parametrize("seed", range(3))
def test_a_way_is_a_chain_of_neighbours_that_can_be_passed(seed: int) -> None:
    scene, where = spheres(seed), corridor()
    table = empty_lattice()
    _, slot, _ = explore(table, where, scene)
    points = []
    while slot >= 0:
        points.append(lattice.middle(where, table.keys[slot]))
        slot = table.before[slot]
    way = np.array(points)
    assert np.linalg.norm(way[0]) <= where.close
    assert np.linalg.norm(way[-1] - where.goal) <= HALF_DIAGONAL * CELL
    assert np.abs(np.diff(way, axis=0)).max() <= CELL * (1 + 1e-9)
    assert scene.distance(way).min() >= where.least


@pytest.mark.parametrize("point", [(0.0, 0.0, 0.0), (-3.21, 4.05, -0.001), (100.03, -250.0, 7.7), (1e4, -1e4, 1e4)])
def test_a_point_lies_in_its_cube(point: Any) -> None:
    where = corridor(origin=(0.03, -0.07, 0.11))
    middle = lattice.middle(where, lattice.cube_of(where, point))
    assert np.abs(np.subtract(middle, point)).max() <= 0.5 * CELL * (1 + 1e-9)


def test_cubes_are_found_again_in_a_crowded_table() -> None:
    table = empty_lattice(1 << 10)
    rng = np.random.default_rng(0)
    keys = {lattice.cube_of(corridor(), tuple(p)) for p in rng.uniform(-2.0, 2.0, (900, 3))}
    slots = {}
    for key in keys:
        slot = lattice.find_slot(table, key)
        assert table.keys[slot] == 0
        table.keys[slot] = key
        slots[key] = slot
    assert all(lattice.find_slot(table, key) == slot for key, slot in slots.items())


def room(wall: float, half: float = 0.6) -> Scene:
    """Six thin walls about the goal."""
    goal, full = np.array(corridor().goal), 2.0 * half + wall
    walls = []
    for axis in range(3):
        for side in (-half, half):
            center, size = goal.copy(), np.full(3, full)
            center[axis] += side
            size[axis] = wall
            walls.append(Box(center, size))
    return Scene(walls)


@pytest.mark.parametrize("wall", [1e-6, 0.05])
def test_half_a_radius_does_not_leak_through_a_wall(wall: float) -> None:
    cell = 0.5 * RADIUS
    where = corridor(cell=cell, least=RADIUS - HALF_DIAGONAL * cell, reach=3.0, close=HALF_DIAGONAL * cell)
    ended, _, cubes = explore(empty_lattice(), where, room(wall))
    assert ended == CLOSED
    assert cubes < 2000


def test_closed_is_said_exactly_where_free_space_is_cut_in_two() -> None:
    for seed in range(8):
        rng = np.random.default_rng(seed)
        goal = np.array(corridor().goal)
        around = rng.normal(size=(90, 3))
        shell = goal + 0.5 * around / np.linalg.norm(around, axis=1, keepdims=True)
        kept = shell[np.linalg.norm(shell, axis=1) > 0.1 + RADIUS + 0.05][: rng.integers(50, 90)]
        scene = Scene([Sphere(center, 0.1) for center in kept])
        where = corridor(reach=1.6)
        ended, _, _ = explore(empty_lattice(), where, scene)
        axis = CELL * np.arange(-9, 10)
        grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
        free = (scene.distance(grid) >= where.least) & within_reach(grid, 1.6)
        parts, _ = label(free, np.ones((3, 3, 3)))
        seeds = parts[(np.linalg.norm(grid - goal, axis=-1) <= HALF_DIAGONAL * CELL) & free]
        joined = parts[9, 9, 9] in seeds.tolist()
        if not joined:
            assert ended == CLOSED
        elif ended == CLOSED:  # only walls between two neighbours may divide more than the cubes do
            assert (scene.distance(grid)[free] < CELL).any()


def test_a_full_table_and_a_spent_time_are_said() -> None:
    far = corridor(reach=50.0, goal=(9.0, 0.0, 0.0))
    assert explore(empty_lattice(1 << 8), far, Scene())[0] == FULL
    assert explore(empty_lattice(), far._replace(room=1e9), Scene([Sphere((3, 0, 0), 1.0)]), deadline=0.0)[0] == LATE


def test_a_goal_larger_than_the_table_fills_it_and_ends() -> None:
    assert explore(empty_lattice(1 << 8), corridor(reach=50.0, around=2.0), Scene())[0] == FULL


def test_nothing_passes_behind_the_backs_of_the_ends() -> None:
    where = corridor(goal=(0.0, 0.0, -0.8), axis=(0.0, 0.0, 1.0), turn=0.7, reach=3.0)
    table = empty_lattice()
    ended, slot, _ = explore(table, where, Scene())
    assert ended == FOUND
    widest = 0.0
    while slot >= 0:
        p = lattice.middle(where, table.keys[slot])
        assert not (p[2] < -CELL and math.hypot(*p) < 0.7)
        widest = max(widest, math.hypot(p[0], p[1]))
        slot = table.before[slot]
    assert widest >= 0.6


def test_the_next_way_differs() -> None:
    scene = Scene([Sphere((0.5, 0.25, 0.4), 0.2)])
    where, table = corridor(reach=3.0), empty_lattice()
    _, slot, cubes = explore(table, where, scene)
    first = trace(table, where, slot)
    lattice.surcharge(table, where, slot, 4.0, 2)
    lattice.restart(table)
    _, slot, _ = lattice.explore(table, where, kernel_scene(scene), np.zeros(2, np.int64), math.inf, cubes)
    second = trace(table, where, slot)
    apart = np.linalg.norm(first[:, None] - second[None], axis=-1).min(axis=0)
    assert apart.max() > 2.0 * CELL


def trace(table: Lattice, where: Corridor, slot: int) -> Floats:
    points = []
    while slot >= 0:
        points.append(lattice.middle(where, table.keys[slot]))
        slot = int(table.before[slot])
    return np.array(points)
