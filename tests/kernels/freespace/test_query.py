"""Queries, and the grids that are made of them."""

import math

import pytest

from sinuous.kernels.fields.solids import UPPER_BOUND
from sinuous.kernels.freespace.grid import HALF_DIAGONAL
from sinuous.kernels.freespace.query import proof_grid, read_query, route_grid
from sinuous.scene.obstacles import Box
from sinuous.scene.scene import Scene
from tests.helpers import kernel_scene
from tests.kernels.freespace.places import query


def test_straight_pieces_end_at_a_wall() -> None:
    asked = read_query(query(turn=1.0, back=(0.0, 0.0, -1.0), free_length=0.1))
    open_grid = route_grid(asked, kernel_scene(Scene()), 0.0, True)
    assert open_grid.start == pytest.approx((0.0, 0.0, 0.6))
    assert open_grid.goal == pytest.approx((0.0, 0.0, 1.5))
    assert open_grid.longest == pytest.approx(3.0 - 0.6 - 0.5 + 0.05)
    wall = Scene([Box((0.0, 0.0, 0.4), (1.0, 1.0, 0.1))])
    closed = route_grid(asked, kernel_scene(wall), 0.0, True)
    assert 0.1 < closed.start[2] <= 0.25
    further = route_grid(asked, kernel_scene(Scene()), 0.7, True)
    assert further.start == pytest.approx((0.0, 0.0, 1.2))


def test_a_proof_grants_whatever_any_body_may_do() -> None:
    asked = read_query(query(free_length=0.3, goal_radius=0.2, goal_slack=0.01, clearance=0.09))
    grid = proof_grid(asked, kernel_scene(Scene()))
    assert (grid.turn, grid.longest, grid.mode) == (0.0, math.inf, UPPER_BOUND)
    assert grid.clearance == pytest.approx(0.1 - HALF_DIAGONAL * 0.05)
    assert grid.start_radius == pytest.approx(0.3 + HALF_DIAGONAL * 0.05)
    assert grid.goal_radius == pytest.approx(0.21)
