"""The door of the route search: polylines from origin to goal, and how a search ends."""

from typing import NamedTuple

import numpy as np

import sinuous as sn
from sinuous.kernels.freespace.cells import memory_size
from sinuous.kernels.freespace.find import find_routes
from sinuous.kernels.tables import CLOSED, FOUND, FULL, PROVED_CLOSED, QUERY_MOST_CELLS, TIMED_OUT
from tests.helpers import Floats
from tests.kernels.freespace.places import query, room

POINTS = 100
BALL = sn.Scene([sn.Sphere((0.0, 0.0, 1.0), 0.3)])


class Found(NamedTuple):
    routes: list[Floats]
    ended: int
    cells: int


def find(scene: sn.Scene, asked: Floats, most: int = 1, seconds: float = 60.0) -> Found:
    routes, counts = np.empty((most, POINTS, 3)), np.zeros(most, np.int64)
    memory = np.full(memory_size(int(asked[QUERY_MOST_CELLS])), np.nan)  # nothing of what was there before may matter
    group = scene.snapshot().group.copy()
    found, ended, cells = find_routes(group, asked, seconds, memory, routes, counts)
    return Found([r[:c] for r, c in zip(routes[:found], counts, strict=False)], ended, cells)


def test_a_route_runs_from_origin_to_goal_evenly_and_clear() -> None:
    found = find(BALL, query())
    assert (len(found.routes), found.ended) == (1, FOUND)
    route = found.routes[0]
    assert np.allclose(route[0], (0, 0, 0))
    assert np.allclose(route[-1], (0, 0, 2))
    steps = np.linalg.norm(np.diff(route, axis=0), axis=1)
    assert steps.min() > 0.8 * steps.max()
    assert BALL.distance(route).min() > 0.1
    assert 2.0 < steps.sum() < 2.4


def test_a_route_stays_in_the_plane_that_it_is_asked_to_stay_in() -> None:
    normal = np.array([0.6, 0.8, 0.0])
    found = find(BALL, query(normal=normal))
    assert np.abs(found.routes[0] @ normal).max() < 1e-12
    assert BALL.distance(found.routes[0]).min() > 0.1
    across = sn.Scene([sn.Cylinder((-4.0, 3.0, 1.0), (4.0, -3.0, 1.0), 0.2)])  # in the plane there is no way past it
    assert find(across, query(normal=normal)).ended == CLOSED
    assert find(across, query()).ended == FOUND


def test_alternatives_pass_an_obstacle_on_different_sides() -> None:
    found = find(BALL, query(), most=4)
    assert len(found.routes) == 4
    sides = {tuple(np.sign(np.round(route[np.abs(route[:, 2] - 1.0).argmin(), :2], 1))) for route in found.routes}
    assert len(sides) >= 3


def test_a_goal_in_a_closed_room_has_no_route_and_that_is_proved_when_asked_for() -> None:
    walls = room(0.02, 0.3, (0.0, 0.0, 2.0))
    assert find(walls, query()).ended == PROVED_CLOSED
    assert find(walls, query(prove=False)).ended == CLOSED
    assert find(walls, query(goal_radius=0.6)).ended != PROVED_CLOSED


def test_an_origin_in_a_closed_room_leaves_it_by_its_free_length() -> None:
    walls = room(0.02, 0.3, (0.0, 0.0, 0.0))
    assert find(walls, query(longest=2.2, most_cells=1 << 15)).ended == PROVED_CLOSED
    assert find(walls, query(free_length=0.45)).ended == FOUND


def test_a_full_table_and_a_spent_time_are_said() -> None:
    assert find(BALL, query(most_cells=128)).ended == FULL
    assert find(room(0.02, 0.6, (0.0, 0.0, 2.0)), query(), seconds=-1.0).ended == TIMED_OUT
