"""Blocking surfaces close the passage that a route leads through, and no other one."""

import itertools

import numpy as np
import pytest

import sinuous as sn
from sinuous.scene.obstacles import Obstacle
from sinuous.solver.route_classes.curves import RouteCurves
from sinuous.solver.route_classes.passages import Passage, SurfaceBounds, make_blocking_surface, passages, refined
from tests.helpers import Floats, present
from tests.solver.route_classes.places import ACROSS, DOORS, ROBOT, thin_wall, wall

ENDS = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 250.0)])
BOUNDS = SurfaceBounds(ENDS, 20.0, 300.0, 0.8, 4.0)


def curves(scene: list[Obstacle]) -> RouteCurves:
    return RouteCurves(ROBOT, sn.Scene(scene).snapshot())


def made(own: RouteCurves, passage: Passage, bounds: SurfaceBounds) -> sn.Mesh:
    closing = make_blocking_surface(own, passage, bounds)
    return present(closing)


def line(*corners: tuple[float, float, float], count: int = 120) -> Floats:
    """Points on a line through corners."""
    parts = [np.linspace(a, b, count, endpoint=False) for a, b in itertools.pairwise(corners)]
    return np.vstack([*parts, corners[-1]])


@pytest.mark.parametrize("tilt", [0.0, 40.0, -40.0])
@pytest.mark.parametrize("door", [0, 1])
def test_a_blocking_surface_in_a_door_closes_it_and_leaves_the_other_open(door: int, tilt: float) -> None:
    own, place = curves(wall()), (0.5 * sum(DOORS[door]), 0.0, 150.0)
    route = line((place[0] - tilt, 0.0, 110.0), place, (place[0] + tilt, 0.0, 190.0))
    passage, *_ = passages(route, own.scene.distance(route), BOUNDS)
    closed = own.scene.beside([made(own, passage, BOUNDS)])
    rng = np.random.default_rng(0)
    through = np.column_stack([rng.uniform(-12.0, 12.0, 500), rng.uniform(-ACROSS, ACROSS, 500)])
    for this, edges in enumerate(DOORS):
        for x, y in through + np.array([0.5 * sum(edges), 0.0]):
            crossing = np.column_stack([np.full(81, x), np.full(81, y), np.linspace(120.0, 180.0, 81)])
            if own.scene.distance(crossing).min() > BOUNDS.keep:
                assert (closed.distance(crossing).min() < 0.5) == (this == door)


WALLS = [
    (178.7, 5.2, 251.6, [[[23.5, 6.5], [40.9, 24.1]], [[-4.7, 95.3], [14.1, 107.4]]]),
    (157.9, 6.8, 235.0, [[[-0.4, -5.6], [17.9, 13.6]], [[65.8, 15.4], [85.6, 27.8]], [[4.3, 30.6], [25.4, 48.5]]]),
    (
        130.3,
        4.0,
        192.1,
        [
            [[22.0, -79.8], [38.8, -63.4]],
            [[4.4, -23.3], [25.5, -7.8]],
            [[-25.1, -92.8], [-4.0, -71.3]],
            [[61.2, -19.9], [82.0, 2.4]],
        ],
    ),
]
"""Where a wall stands, its thickness, how high the target is, and doors (k, 2, 2) in x and y."""


@pytest.mark.parametrize(("middle", "thickness", "high", "edges"), WALLS)
def test_a_blocking_surface_in_a_thin_wall_leaves_the_other_doors_open(
    middle: float, thickness: float, high: float, edges: list[list[list[float]]]
) -> None:
    doors = np.array(edges)
    own = RouteCurves(ROBOT, sn.Scene(thin_wall(doors, middle, thickness)).snapshot())
    bounds = SurfaceBounds(np.array([np.zeros(3), (30.0, 20.0, high)]), 30.0, 360.0, 0.8, 5.6)
    middles = [(*door.mean(axis=0), middle) for door in doors]
    for i, place in enumerate(middles):
        aside = np.array([4.0, -12.0, 20.0])
        route = refined(line(tuple(place - aside), place, tuple(place + aside), count=4), 2.0)
        passage, *_ = passages(route, own.scene.distance(route), bounds)
        closed = own.scene.beside([made(own, passage, bounds)]).distance(np.array(middles))
        assert closed[i] < 1.0
        assert (np.delete(closed, i) > 3.0).all()
