"""Shapes from elsewhere are judged as solutions are."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import refused

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.1)
BALL = sn.Sphere((0.0, 0.0, 2.0), 0.3, name="ball")
Q = np.random.default_rng(0).uniform((-0.9, -0.9, 0.7), (0.9, 0.9, 1.2), (2, 4, 3, 3))
TIP = ROBOT.tip(Q[0, 0])
TARGET = sn.Target(TIP[:3, 3], direction=TIP[:3, 2])


def test_one_shape_is_judged_as_a_solution_is() -> None:
    problem = sn.Problem(ROBOT, [TARGET, sn.Target((0, 0, 1), segment=1)], [BALL], sn.Tolerance(0.1, 0.2))
    found = sn.check(ROBOT, Q[0, 1], [BALL], problem.targets, tolerance=sn.Tolerance(0.1, 0.2))
    from sinuous.solution.verification import verify

    assert found == verify(problem, Q[0, 1])
    assert sn.check(ROBOT, Q[0, 0].tolist(), targets=TARGET).position_error < 1e-12


def test_without_targets_limits_and_clearance_remain() -> None:
    straight = np.tile([0.0, 0.0, 1.0], (3, 1))
    assert sn.check(ROBOT, straight).ok
    through = sn.check(ROBOT, straight, [BALL])
    assert (through.ok, through.obstacle, through.position_error) == (False, "ball", 0.0)
    assert through.clearance == pytest.approx(-0.4)
    long = sn.check(ROBOT, straight * 1.3)
    assert (long.ok, long.obstacle) == (False, None)
    assert long.excess == pytest.approx(0.1)


@pytest.mark.parametrize("scene", [None, [BALL]])
def test_a_batch_is_the_same_as_one_by_one(scene: Any) -> None:
    many: Any = sn.check(ROBOT, Q, scene, TARGET)
    assert many.ok.shape == (2, 4)
    assert many.ok.dtype == bool
    for place in np.ndindex(2, 4):
        one = sn.check(ROBOT, Q[place], scene, TARGET)
        for name, value in vars(one).items():
            assert getattr(many, name)[place] == value
    assert many.clearance.dtype == many.excess.dtype == float
    nothing: Any = sn.check(ROBOT, Q[:0], scene)
    assert nothing.ok.shape == (0, 4)
    assert nothing.ok.dtype == bool


def test_bad_input_is_refused() -> None:
    three: Any = 3
    refused("robot", lambda: sn.check(three, Q))
    refused("q", lambda: sn.check(ROBOT, Q[..., :2]), "3, 3)")
    refused("q", lambda: sn.check(ROBOT, np.full((3, 3), np.nan)))
    refused("scene[0]", lambda: sn.check(ROBOT, Q, [three]))
    refused("targets[0]", lambda: sn.check(ROBOT, Q, None, [three]))
    refused("targets[0].segment", lambda: sn.check(ROBOT, Q, None, sn.Target((0, 0, 1), segment=4)))
    refused("tolerance", lambda: sn.check(ROBOT, Q, tolerance=three))
