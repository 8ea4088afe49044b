"""The whole path at once, made shorter."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.arguments import Shortest
from sinuous.base.checks import Floats
from sinuous.motion.shortening import metric_of
from tests.helpers import refused

ROBOT = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0, radius=0.05, tendons=sn.Tendons(3, 0.04))
PATH = [sn.Target((2.0 * np.cos(turn), 2.0 * np.sin(turn), 2.5)) for turn in np.linspace(0.0, 2.0, 12)]
BALL = sn.Sphere((0.9, 0.3, 1.2), 0.3, name="ball")


def effort(motion: sn.Motion, metric: Floats) -> float:
    steps = np.diff(motion.q.reshape(len(motion.q), -1), axis=0)
    return float((np.einsum("ti,ij,tj->t", steps, metric, steps) / np.diff(motion.times)).sum())


@pytest.mark.parametrize("shortest", ["configuration", "actuators"])
def test_it_gets_easier_and_stays_proved(shortest: Shortest) -> None:
    plain = sn.track(ROBOT, PATH, [BALL], deviation=0.05)
    short = sn.track(ROBOT, PATH, [BALL], deviation=0.05, shortest=shortest)
    metric = metric_of(ROBOT, shortest)
    assert effort(short, metric) < 0.95 * effort(plain, metric)
    assert short.solved
    assert all(verification.ok for verification in short.verify())
    for solution, knot in zip(short.solutions, short.waypoint_knots, strict=True):
        assert knot is not None
        np.testing.assert_array_equal(short.q[knot], solution.q)
    tips = ROBOT.tip(short.q)[:, :3, 3]
    np.testing.assert_allclose(tips, ROBOT.tip(plain.q)[:, :3, 3], atol=2e-3)


def test_what_cannot_be_meant_is_refused() -> None:
    refused("shortest", lambda: sn.track(ROBOT, PATH, shortest="time"), "configuration or actuators")  # type: ignore[arg-type]
    bare = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0)
    refused("shortest", lambda: sn.track(bare, PATH, shortest="actuators"), "no actuators")
