"""Queries, and the grids that are made of them."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sinuous.kernels.fields.solids import ABOVE, STEP
from sinuous.kernels.freespace.grid import HALF_DIAGONAL
from sinuous.kernels.freespace.query import Query, proof_grid, read_query, route_grid, straight_length
from sinuous.scene.obstacles import Box
from sinuous.scene.scene import Scene
from tests.helpers import kernel_scene
from tests.kernels.freespace.places import query


def test_every_number_has_its_own_place() -> None:
    names = [name for name in Query._fields if name != "prove"]
    values: dict[str, Any] = {name: 100.0 + i for i, name in enumerate(names)}
    for i, name in enumerate(("origin", "axis", "goal", "back")):
        values[name] = (3.0 * i, 3.0 * i + 1.0, 3.0 * i + 2.0)
    for prove in (False, True):
        read = read_query(query(**values, prove=prove))
        assert read._asdict() == values | {"prove": prove}


@given(low=st.floats(0.0, 2.0), more=st.floats(0.0, 2.0), other=st.floats(0.0, 2.0), length=st.floats(0.0, 5.0))
def test_a_route_leaves_straight_for_what_the_rest_leaves(low: float, more: float, other: float, length: float) -> None:
    asked = read_query(query(straight_min=low, straight_max=low + more, other_length=other))
    straight = straight_length(asked, length)
    assert straight == pytest.approx(np.clip(length - other, low, low + more))


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


def test_flags_say_what_is_barred_and_how_distances_are_asked_for() -> None:
    scene = kernel_scene(Scene())
    asked = read_query(query())
    assert route_grid(asked, scene, 0.0, True).turn == pytest.approx(0.1)
    assert route_grid(asked, scene, 0.0, False).turn == 0.0
    assert route_grid(asked, scene, 0.0, False).mode == STEP


def test_a_proof_grants_whatever_any_body_may_do() -> None:
    asked = read_query(query(free_length=0.3, goal_radius=0.2, goal_slack=0.01, clearance=0.09))
    grid = proof_grid(asked, kernel_scene(Scene()))
    assert (grid.turn, grid.longest, grid.mode) == (0.0, math.inf, ABOVE)
    assert grid.clearance == pytest.approx(0.1 - HALF_DIAGONAL * 0.05)
    assert grid.start_radius == pytest.approx(0.3 + HALF_DIAGONAL * 0.05)
    assert grid.goal_radius == pytest.approx(0.21)
