"""Motions keep limits of tension, at knots and between them, with and without load; judged at many shapes."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.statics import lacking_stretch, pulls
from sinuous.statics.rest import Rest, Way
from tests.helpers import Floats, refused, states_of
from tests.solver.test_tension_limits import arm

SECONDS = 20.0
LYING = np.array([[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
UP, DOWN = np.array([[0.4466, 0.0, 0.1], [0.2549, 0.0, 0.1]]), np.array([[-1.3041, 0.0, 0.1], [-1.3435, 0.0, 0.1]])
"""Between these the arm lies level, where its weight pulls the most."""


def loaded(most: float) -> sn.Robot:
    lines = sn.Tendons(4, 0.004, stiffness=4000.0, tension=(0.0, most))
    segment = sn.Segment(0.1, max_bend=2.5, radius=0.005, tendons=lines)
    rod = sn.Stiffness(0.002)
    return sn.Robot([segment] * 2, stiffness=rod, mass=0.8, arcs=4, gravity=(0.0, 0.0, -9.81), base=LYING)


def most_pulled(robot: sn.Robot, q: Floats, looks: int = 9) -> float:
    """The greatest tension that is seen on the way, by energies that share no code with the equilibrium."""
    ways = [Way(Rest(robot, one), Rest(robot, other)) for one, other in pairwise(q)]
    rests = [way.rest(share) for way in ways for share in np.linspace(0.0, 1.0, looks).tolist()]
    return float(np.nanmax(pulls(robot, *states_of(rests))))


def test_tensions_between_knots_under_load_are_bounded_or_not_proved() -> None:
    ends = np.stack([UP, DOWN])
    greatest = most_pulled(loaded(1e6), ends)
    at_ends = max(most_pulled(loaded(1e6), np.stack([q, q]), 1) for q in ends)
    assert at_ends < 0.9 * greatest, "ends say all of it"
    tight = sn.Motion(loaded(0.5 * (at_ends + greatest)), ends)
    assert not tight.solved
    assert not tight.verify().ok
    refused("q[1]", lambda: sn.Motion(loaded(0.9 * at_ends), ends), "actuator")


def test_proved_motions_under_load_keep_limits_of_tension() -> None:
    random, proved = np.random.default_rng(5), 0
    for _ in range(12):
        q = UP + np.concatenate([random.uniform(-0.6, 0.2, (2, 2)), np.zeros((2, 1))], axis=1)
        ends = np.stack([q, q + np.concatenate([random.uniform(-0.3, 0.3, (2, 2)), np.zeros((2, 1))], axis=1)])
        at_ends = max(most_pulled(loaded(1e6), np.stack([each, each]), 1) for each in ends)
        robot = loaded(1.02 * at_ends)
        if any(robot.violations(each) for each in ends):
            continue
        motion = sn.Motion(robot, ends)
        proved += motion.solved
        assert not motion.solved or most_pulled(robot, motion.q) <= 1.02 * at_ends * (1.0 + 1e-9)
    assert proved > 0


@pytest.mark.parametrize("length", [60.0, (40.0, 80.0)], ids=["lengths stay", "lengths vary"])
def test_plans_and_tracks_without_load_keep_limits_of_tension(length: Any) -> None:
    robot, random = arm(length), np.random.default_rng(4)
    solved = 0
    for _ in range(4):
        q = np.array([[0.3, 0.2, 60.0], [0.3, -0.2, 60.0]]) + random.uniform(-0.1, 0.1, (2, 3))
        q[:, 2] = 60.0
        goal = q * [-1.0, -1.0, 1.0]
        ball = sn.Sphere(robot.tip(0.5 * (q + goal))[:3, 3], 6.0)
        motion = sn.plan(robot, q, goal, [ball], time=SECONDS)
        track = sn.track(
            robot, [sn.Target(robot.tip(each)[:3, 3]) for each in (q, goal)], start=q, time=SECONDS, reconfigure="allow"
        )
        for found in (motion, track):
            solved += found.solved
            assert not found.solved or _is_within(robot, found.q)
    assert solved > 4


def _is_within(robot: sn.Robot, q: Floats) -> bool:
    shares = np.linspace(0.0, 1.0, 9)[:, None, None]
    between = [(1.0 - shares) * one + shares * other for one, other in pairwise(q)]
    shapes = np.concatenate(between)
    return robot.excess(shapes) <= 2e-9 * robot.mean_length and lacking_stretch(robot, shapes[4]) <= 1e-7


def test_a_motion_from_elsewhere_between_knots_that_are_held() -> None:
    robot = arm((10.0, 80.0))
    one = [[-0.844, -0.686, 40.36], [-0.285, -0.022, 21.39]]
    other = [[-0.278, -0.049, 22.55], [-0.388, 0.959, 63.66]]
    q = np.array([one, other])
    assert robot.excess(q) < 1e-12
    assert robot.excess(q.mean(axis=0)) > 0.05
    motion = sn.Motion(robot, q)
    assert not motion.solved
    assert not motion.verify().ok
    shorter = sn.Motion(robot, [one, q[0] * [0.8, 0.8, 1.0]])
    assert shorter.solved
    assert shorter.verify().ok
