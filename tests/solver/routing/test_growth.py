"""Routes that are divided into legs, from target to target."""

import numpy as np

from sinuous import Robot, Scene, Segment, Target
from sinuous.problem.problem import Problem
from sinuous.solver.routing.growth import LEG_POINTS, divide_route
from tests.helpers import kernel_groups

RADIUS = 0.1
ROBOT = Robot([Segment((0.8, 1.2), 2.0, radius=RADIUS)] * 6)


def test_a_route_is_divided_at_the_elbows_that_it_leads_past() -> None:
    elbow, tip = Target((0.05, 0.0, 2.0), segment=3), Target((0.0, 0.0, 4.8))
    route = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.8), 300)
    both, alone = (kernel_groups(Problem(ROBOT, targets, Scene())) for targets in ([elbow, tip], [tip]))
    legs = divide_route(both, route, RADIUS)
    assert legs is not None
    assert legs.shape == (2, LEG_POINTS, 3)
    assert np.allclose(legs[:, [0, -1]], [[route[0], elbow.position], [elbow.position, route[-1]]])
    assert divide_route(both, route, 0.04) is None
    whole = divide_route(alone, route, RADIUS)
    assert whole is not None
    assert np.allclose(whole, np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.8), LEG_POINTS))
