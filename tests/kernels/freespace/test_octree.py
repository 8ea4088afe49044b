"""Cells of several sizes, against the finest ones that they stand for."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels.freespace import octree
from sinuous.kernels.freespace.cells import BLOCKED, DIVIDED, NONE
from sinuous.kernels.freespace.grid import HALF_DIAGONAL, SearchGrid, middle
from sinuous.kernels.freespace.keys import key_of, touch
from tests.helpers import Floats, kernel_scene
from tests.kernels.freespace.places import CELL, grid, spheres

SMALL = st.tuples(st.integers(0, 3), *[st.integers(-9, 9)] * 3)


def finest(cell: tuple[int, int, int, int]) -> Any:
    """Numbers (m, 3) of the finest cells in a cell."""
    edge = 1 << cell[0]
    return edge * np.array(cell[1:]) + np.stack(np.meshgrid(*[np.arange(edge)] * 3, indexing="ij"), -1).reshape(-1, 3)


@given(one=SMALL, other=SMALL)
def test_cells_touch_where_two_of_their_finest_cells_are_neighbours(one: Any, other: Any) -> None:
    between = np.abs(finest(one)[:, None] - finest(other)[None]).max(axis=-1).min()
    assert touch(key_of(*one), key_of(*other)) == (between <= 1)


def middles(where: SearchGrid, cell: tuple[int, int, int, int]) -> Floats:
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
        d, cut = octree.classify_cell(where, kernel_scene(scene), key_of(*cell))
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
