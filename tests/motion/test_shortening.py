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


def test_a_path_that_leaves_nothing_open_stays() -> None:
    robot = sn.Robot.uniform(3, 1.0, max_bend=3.0)
    q = np.array([[0.3, 0.9, 1.0], [-0.8, 0.4, 1.0], [0.2, -0.7, 1.0]])
    poses = [robot.tip(q + 0.05 * i * np.eye(3)[0]) for i in range(4)]
    path = [sn.Target(pose[:3, 3], rotation=pose[:3, :3]) for pose in poses]
    exact = sn.Tolerance(1e-9, 1e-9)
    plain = sn.track(robot, path, start=q, tolerance=exact, deviation=1.0)
    short = sn.track(robot, path, start=q, tolerance=exact, deviation=1.0, shortest="configuration")
    np.testing.assert_allclose(short.q, plain.q, atol=1e-3)


@pytest.mark.parametrize("scale", [1e-6, 1e3])
def test_the_length_unit_does_not_matter(scale: float) -> None:
    robot = sn.Robot.uniform(4, (0.8 * scale, 1.2 * scale), max_bend=2.0, radius=0.05 * scale)
    path = [sn.Target(scale * np.asarray(target.position)) for target in PATH]
    own = sn.track(sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0, radius=0.05), PATH, shortest="configuration")
    motion = sn.track(robot, path, shortest="configuration")
    np.testing.assert_allclose(motion.q / [1.0, 1.0, scale], own.q, atol=1e-6)


def test_what_cannot_be_meant_is_refused() -> None:
    refused("shortest", lambda: sn.track(ROBOT, PATH, shortest="time"), "configuration or actuators")  # type: ignore[arg-type]
    bare = sn.Robot.uniform(4, (0.8, 1.2), max_bend=2.0)
    refused("shortest", lambda: sn.track(bare, PATH, shortest="actuators"), "no actuators")
