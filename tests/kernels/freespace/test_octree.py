"""Cells of several sizes, against the finest ones that they stand for."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.kernels.freespace import octree
from sinuous.kernels.freespace.cells import BLOCKED, DIVIDED, NONE, Memory, key_in
from sinuous.kernels.freespace.grid import HALF_DIAGONAL, Grid, cell_at, middle
from sinuous.kernels.freespace.keys import key_of, numbers_of
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_scene
from tests.kernels.freespace.places import CELL, RADIUS, grid, memory, spheres
from tests.kernels.freespace.test_keys import finest


def middles(where: Grid, cell: tuple[int, int, int, int]) -> Floats:
    """Middles of the finest cells in a cell."""
    found: Floats = np.array(where.origin) + where.cell * finest(cell)
    return found


@pytest.mark.parametrize("seed", range(4))
def test_all_finest_cells_of_a_cell_are_as_it_says(seed: int) -> None:
    scene, rng = spheres(seed), np.random.default_rng(seed)
    where = grid(levels=4, reach=2.5)
    told = []
    for _ in range(300):
        x, y, z = (int(n) for n in rng.integers(-5, 6, 3))
        cell = (int(rng.integers(0, 4)), x, y, z)
        d, cut = octree.passable(where, kernel_scene(scene), key_of(*cell))
        points = middles(where, cell)
        far = np.linalg.norm(points, axis=1) + np.linalg.norm(points - where.goal, axis=1)
        distances = np.where(far <= where.reach + 2.0 * HALF_DIAGONAL * CELL, scene.distance(points), -np.inf)
        told.append("blocked" if d == BLOCKED else "divided" if d == DIVIDED else "free")
        assert cut == NONE
        if d == BLOCKED:
            assert (distances < where.clearance).all()
        elif d > DIVIDED:
            within = distances[distances > -np.inf]  # a part may be out of reach
            assert (within >= (where.ample if cell[0] else where.clearance) - 1e-12).all()
            assert d == pytest.approx(scene.distance(np.array(middle(where, key_of(*cell)))))
    assert set(told) == {"blocked", "divided", "free"}


def leaf_of(work: Memory, where: Grid, scene: Scene, p: Any) -> int:
    return int(octree.leaf_at(work, where, kernel_scene(scene), cell_at(where, p)))


def test_every_point_lies_in_one_leaf_whoever_asks_first() -> None:
    scene, where = spheres(1), grid(levels=3)
    rng = np.random.default_rng(0)
    points = [tuple(p) for p in rng.uniform(-0.9, 0.9, (200, 3))]
    told = []
    for order in (points, points[::-1]):
        work = memory()
        leaves = {p: leaf_of(work, where, scene, p) for p in order}
        told.append([key_in(work.table, leaves[p]) if leaves[p] != NONE else NONE for p in points])
    assert told[0] == told[1]
    for p, key in zip(points, told[0], strict=True):
        if key != NONE:
            edge = CELL * 2 ** numbers_of(key)[0]
            assert np.abs(np.subtract(middle(where, key), p)).max() <= 0.5 * edge * (1 + 1e-9)
    assert len({numbers_of(key)[0] for key in told[0] if key != NONE}) > 1


def test_the_open_is_one_cell_and_a_full_table_is_none() -> None:
    where, work = grid(levels=4, reach=100.0), memory(64)
    assert len({leaf_of(work, where, Scene(), p) for p in np.random.default_rng(0).uniform(0.0, 3.0, (50, 3))}) == 1
    ball = Scene([Sphere((0.0, 0.0, 0.0), 0.05)])
    assert leaf_of(memory(16), where, ball, (0.0, 0.3, 0.3)) == NONE


def test_a_known_leaf_is_found_and_nobody_is_asked() -> None:
    where, work, ball = grid(levels=3, reach=100.0), memory(), Scene([Sphere((0.0, 0.0, 0.0), 0.1)])
    scene, key = kernel_scene(ball), cell_at(where, (2.5, 0.1, 0.1))
    assert octree.known_leaf(work, where, scene, key) == NONE
    leaf = leaf_of(work, where, ball, (2.5, 0.1, 0.1))
    assert octree.known_leaf(work, where, scene, key) == leaf
    assert octree.known_leaf(work, where, scene, cell_at(where, (0.0, 0.0, 0.0))) == NONE


def test_what_cannot_be_passed_is_blocked() -> None:
    ball = kernel_scene(Scene([Sphere((0.4, 0.0, 0.0), 0.2)]))
    where = grid(turn=0.5, axis=(0.0, 0.0, 1.0), reach=4.0)

    def at(p: Any) -> float:
        return float(octree.passable(where, ball, cell_at(where, p))[0])

    assert at((0.0, 0.2, 0.6)) == pytest.approx(math.sqrt(0.16 + 0.04 + 0.36) - 0.2)
    assert at((0.4, 0.0, 0.2)) == BLOCKED  # too near
    assert at((0.0, 0.0, -0.4)) == BLOCKED  # behind the start
    assert at((0.0, 0.0, -0.8)) > RADIUS
    assert at((0.0, 0.0, -3.0)) == BLOCKED  # out of reach
