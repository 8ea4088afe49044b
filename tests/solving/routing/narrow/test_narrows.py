"""The narrowest place of a line: a door, not a wall that it leads along."""

import numpy as np
import pytest

from sinuous import Box, Robot, Scene, Segment, Target, Tolerance
from sinuous.kernels.tables import TARGET_POSITION
from sinuous.problem.problem import Problem
from sinuous.solving.polylines import respaced
from sinuous.solving.routing.growth import LEG_POINTS
from sinuous.solving.routing.narrow.narrows import Narrows
from sinuous.solving.routing.searches import Searches
from tests.helpers import kernel_groups

RADIUS = 0.1
ROBOT = Robot([Segment((0.3, 0.4), 1.8, radius=RADIUS)] * 14)
DOOR = 1.5 * RADIUS
SCENE = Scene(
    [Box((0.0, 0.0, -1.0), (8.0, 8.0, 2.0)), *(Box((2.0, y * (2.0 + DOOR), 2.0), (0.1, 4.0, 4.0)) for y in (-1, 1))]
)
"""A floor, and a wall with a door from the floor on."""

ALONG = 0.13
"""How far the route leads above the floor: nearer than the door is narrow."""

ROUTE = np.array(
    [(0.0, 0.0, 0.8), (0.3, 0.0, ALONG), (1.2, 0.0, ALONG), (1.6, 0.0, 0.6), (2.6, 0.0, 0.6), (3.2, 0.0, 1.5)]
)


def test_the_gate_is_in_the_door_and_not_along_the_floor() -> None:
    searches = Searches(ROBOT, SCENE, Tolerance().for_robot(ROBOT))
    problem = Problem(ROBOT, [Target(ROUTE[-1])], SCENE)
    legs = respaced(ROUTE, LEG_POINTS)[None]
    assert SCENE.distance(legs[0]).argmin() < SCENE.distance(legs[0])[80:].argmin() + 80
    narrows = Narrows(
        kernel_groups(problem),
        lambda points: searches.room(problem, points),
        lambda line: searches.beside(problem, line),
        lambda: 60.0,
    )
    crossing = narrows.crossing(1, legs)
    assert len(crossing) > 0
    assert narrows.room(1, legs) == pytest.approx(ALONG / RADIUS, rel=0.01)
    way = crossing._passage.way(0, crossing._passage.places[0].counts[0])
    assert way.rows[0][TARGET_POSITION] == pytest.approx(2.0, abs=0.2)
