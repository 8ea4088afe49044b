"""Detours of routes: each leg as long as its segments may be, in many ways."""

from itertools import pairwise

import numpy as np

from sinuous import Robot, Scene, Segment, Sphere, Target
from sinuous.problem.problem import Problem
from sinuous.solver.polylines import lengths_along
from sinuous.solver.routing.growth import LEG_POINTS, lengthen_route
from sinuous.solver.routing.partial_problems import Groups
from tests.helpers import Floats, kernel_groups

SCENE = Scene([Sphere((0.5, 0.0, 1.5), 0.3)])


def groups_of(length: tuple[float, float] | float, *targets: Target) -> Groups:
    return kernel_groups(Problem(Robot([Segment(length, 2.0, radius=0.1)] * 6), list(targets), SCENE))


def legs_to(*heights: float) -> Floats:
    ends = np.array([0.0, *heights])
    return np.stack([np.linspace((0, 0, a), (0, 0, b), LEG_POINTS) for a, b in pairwise(ends)])


def test_each_leg_becomes_as_long_as_its_own_segments() -> None:
    elbow, tip = Target((0.0, 0.0, 1.9), segment=2), Target((0.0, 0.0, 3.0))
    legs = legs_to(1.9, 3.0)
    longer = lengthen_route(groups_of(1.0, elbow, tip), legs, 0, lambda: 60.0)
    assert longer is not None
    np.testing.assert_allclose(longer[:, [0, -1]], legs[:, [0, -1]])
    first, second = (float(lengths_along(leg)[-1]) for leg in longer)
    assert 1.85 < first <= 2.0
    assert 3.4 < second <= 4.0


def test_a_body_that_is_as_long_as_its_route_needs_no_detour() -> None:
    assert lengthen_route(groups_of(1.0, Target((0.0, 0.0, 5.9))), legs_to(5.9), 0, lambda: 60.0) is None


def test_detours_differ_and_each_is_the_same_again() -> None:
    groups, legs = groups_of((0.8, 1.2), Target((0.0, 0.0, 3.0))), legs_to(3.0)
    made = [lengthen_route(groups, legs, number % 3, lambda: 60.0) for number in range(6)]
    assert all(leg is not None for leg in made)
    np.testing.assert_array_equal(np.array(made[:3]), np.array(made[3:]))
    lengths = [float(lengths_along(leg[0])[-1]) for leg in made[:3] if leg is not None]
    assert max(lengths) - min(lengths) > 0.3
