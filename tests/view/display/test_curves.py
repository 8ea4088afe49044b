"""Distances of the body from obstacles, place by place."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.view.display.results import clearances_along


def test_a_loaded_body_is_where_its_load_bends_it() -> None:
    robot = sn.Robot.uniform(2, 0.1, stiffness=0.004, mass=0.1, arcs=3, gravity=(0, 0, -9.81), radius=0.005)
    q = np.array([[0.8, 0.2, 0.1], [0.5, -0.3, 0.1]])
    ball = sn.Sphere(robot.shape(q).tip[:3, 3], 0.01)
    scene = sn.Scene([ball]).snapshot()
    own = clearances_along(robot, scene, np.stack([q, q]), 4)
    assert own.shape == (2, 9)
    assert own[0, -1] == pytest.approx(-0.015, abs=1e-9)
    assert clearances_along(robot.changed(gravity=None), scene, q, 4)[-1] > 0.0
