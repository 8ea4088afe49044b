"""Cells of a grid: where they are, what they cost, and walls between them."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels.freespace.grid import cell_at, free_distance, middle, price, walled
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


def test_what_cannot_be_passed_has_no_distance() -> None:
    ball = Scene([Sphere((0.4, 0.0, 0.0), 0.2)])
    where = grid(turn=0.5, axis=(0.0, 0.0, 1.0), reach=4.0)
    scene = kernel_scene(ball)
    p = (0.0, 0.2, 0.6)
    assert free_distance(where, scene, p) == pytest.approx(float(ball.distance(p)))
    assert free_distance(where, scene, (0.4, 0.0, 0.2)) == -math.inf  # too near
    assert free_distance(where, scene, (0.0, 0.0, -0.4)) == -math.inf  # behind the start
    assert free_distance(where, scene, (0.0, 0.0, -0.8)) > 0.0
    assert free_distance(where, scene, (0.0, 0.0, -3.0)) == -math.inf  # out of reach
