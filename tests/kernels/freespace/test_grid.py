"""Cells of a grid: where they are, what they cost, and walls between them."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels.freespace.grid import behind, cell_at, corners, middle, price, walled
from sinuous.kernels.freespace.keys import key_of
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene
from tests.helpers import kernel_scene
from tests.kernels.freespace.places import CELL, RADIUS, grid


@pytest.mark.parametrize("point", [(0.0, 0.0, 0.0), (-3.21, 4.05, -0.001), (100.03, -250.0, 7.7), (1e4, -1e4, 1e4)])
def test_a_point_lies_in_its_cell(point: Any) -> None:
    where = grid(origin=(0.03, -0.07, 0.11))
    at = middle(where, cell_at(where, point))
    assert np.abs(np.subtract(at, point)).max() <= 0.5 * CELL * (1 + 1e-9)


@given(a=st.floats(0.0, 2.0), b=st.floats(0.0, 2.0))
def test_less_room_never_costs_less(a: float, b: float) -> None:
    where = grid()
    near, far = sorted((a, b))
    assert price(where, near) >= price(where, far) >= 1.0
    assert price(where, RADIUS + where.room) == 1.0


def test_a_wall_between_two_neighbours_is_seen_however_thin() -> None:
    where = grid()
    one, other = (cell_at(where, p) for p in ((0.0, 0.0, 0.0), (CELL, CELL, 0.0)))
    wall = Scene([Box((0.5 * CELL, 0.5 * CELL, 0.0), (1e-9, 4.0, 4.0))])
    assert walled(where, kernel_scene(wall), one, other)
    assert not walled(where, kernel_scene(Scene([Sphere((2.0, 2.0, 2.0), 0.5)])), one, other)


@given(level=st.integers(0, 5), numbers=st.tuples(*[st.integers(-9, 9)] * 3))
def test_a_cell_has_its_finest_cells_between_its_corners(level: int, numbers: tuple[int, int, int]) -> None:
    where = grid(origin=(0.3, -0.7, 0.11))
    low, high = (np.array(corner) for corner in corners(where, key_of(level, *numbers)))
    assert np.allclose(high - low, CELL * 2**level)
    first = np.array(middle(where, key_of(0, *(n << level for n in numbers))))
    last = np.array(middle(where, key_of(0, *(((n + 1) << level) - 1 for n in numbers))))
    assert np.allclose(first - 0.5 * CELL, low)
    assert np.allclose(last + 0.5 * CELL, high)
    assert np.allclose(middle(where, key_of(level, *numbers)), 0.5 * (low + high))


@given(p=st.tuples(*[st.floats(-1.0, 1.0)] * 3), spread=st.floats(0.0, 0.5))
def test_behind_is_a_half_ball(p: Any, spread: float) -> None:
    where = grid(turn=0.6)
    told = behind(where, p, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), spread)
    near = np.array(p) + spread * np.random.default_rng(0).uniform(-0.57, 0.57, (200, 3))
    inside = (near[:, 2] < -CELL) & (np.linalg.norm(near, axis=1) < 0.6)
    assert told > 0 or not inside.any()
    assert told < 2 or inside.all()
    assert behind(where, p, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), spread) == 0
