"""Contacts of a control step: where a piece of the body is closest to an obstacle."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.body.contacts import PosedBody
from sinuous.kernels.velocity.contacts import closest_place
from tests.helpers import frames_of, kernel_problem


@pytest.mark.parametrize("center", [(1.0, 0.0, 0.5), (0.8, 0.3, -0.5), (0.0, 0.5, 2.0)])
def test_the_closest_place_of_a_piece_is_within_it_or_at_an_end(center: tuple[float, float, float]) -> None:
    robot, scene, q = sn.Robot.uniform(2, 1.0), sn.Scene([sn.Sphere(center, 0.1)]), np.array([[0.3, 0.2, 1.0]] * 2)
    problem = kernel_problem(robot, sn.Target((0.0, 0.0, 2.0)), scene)
    body = PosedBody(robot.limits, q, frames_of(q), 1.0)
    points = robot.backbone(q, 200)
    for k, a, b in ((0, 0.0, 1.0), (0, 0.2, 0.3), (1, 0.5, 1.0)):
        own = points[200 * k + round(200 * a) : 200 * k + round(200 * b) + 1]
        s, d, _, place = closest_place(problem, body, 0, (k, a, b), 1e-6, 50)
        assert a <= s <= b
        assert np.linalg.norm(points[200 * k + round(200 * s)] - place) < 5e-3
        assert d == pytest.approx(float(scene.distance(np.array(place))), abs=1e-12)
        assert d == pytest.approx(float(scene.distance(own).min()), abs=1e-4)
