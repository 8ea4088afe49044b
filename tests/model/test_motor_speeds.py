"""Speeds of motors whose values include a stretch: what finely sampled values along ways show, and no less."""

from itertools import pairwise

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from tests.helpers import refused
from tests.model.test_tension_rows import ROBOTS, drawn, robot_of

LOOKS = 2001
SHARES = np.linspace(0.0, 1.0, LOOKS)[:, None, None]


def places(robot: sn.Robot, count: int = 24) -> Floats:
    q = robot.drive.coordinates.project(drawn(robot, count, 0.5))
    return np.concatenate([robot.straight[None], q, [-0.5 * q[-1] + 1.5 * robot.straight]])


def seen(robot: sn.Robot, ways: Floats) -> Floats:
    """How fast values go at most on ways (looks, n, 3) that take a unit of time."""
    return np.asarray(np.abs(np.diff(robot.drive.values(ways), axis=0)).max(axis=0) * (len(ways) - 1))


@pytest.mark.parametrize("kind", ROBOTS)
def test_speeds_bound_what_is_seen_on_straight_ways_and_are_attained(kind: str) -> None:
    robot = robot_of(kind)
    assert robot.drive.elastic is not None
    slack = 1e-9 * np.abs(robot.drive.jacobian).max()
    close, tendons = 1.03 if kind == "lengths" else 1.0 + 1e-6, kind != "chambers"
    assert robot.drive.elastic.speeds.linear == (kind != "lengths")
    assert robot.drive.elastic.speeds.jumps.all() == tendons
    differ = hidden = 0
    for one, other in pairwise(places(robot)):
        most = robot.drive.greatest_speeds(one, other - one)
        found = seen(robot, one + SHARES * (other - one))
        assert (found <= most + slack).all()
        hidden += int((most > close * found + slack).sum())
        differ += int((np.abs(robot.drive.speeds(other - one)) < most - slack).any())
    assert differ > 12, "stretches change no speed"
    assert hidden <= (20 if kind == "lengths" else 3), "of all 150; a floor that is the highest for a moment may hide"


@pytest.mark.parametrize("kind", [kind for kind in ROBOTS if kind != "lengths"])
def test_speeds_on_parabolas_and_between_jumps(kind: str) -> None:
    robot = robot_of(kind)
    assert robot.drive.elastic is not None
    slack, jumps, breaks = 1e-9 * np.abs(robot.drive.jacobian).max(), 0, robot.drive.elastic.speeds.breaks
    for one, middle, other in zip(*(places(robot)[i : i - 2 or None] for i in range(3)), strict=True):
        begin, end = 2.0 * (middle - one), 2.0 * (other - middle)
        most = robot.drive.greatest_speeds(one, begin, end)
        ways = one + SHARES * begin + 0.5 * SHARES**2 * (end - begin)
        assert (seen(robot, ways) <= most + slack).all()
        ends = [0.0, *breaks(one, other - one), 1.0]
        jumps += len(ends) - 2
        for first, last in pairwise(ends):
            shares = first + (last - first) * np.linspace(1e-6, 1.0 - 1e-6, 21)[:, None, None]
            turns = np.diff(robot.drive.values(one + shares * (other - one)), n=2, axis=0)
            assert np.abs(turns).max() <= 1e-11 * max(1.0, np.abs(most).max()), "a jump between jumps"
    assert (jumps > 10) == (kind != "chambers")


@pytest.mark.parametrize("kind", ROBOTS)
def test_slopes_are_derivatives_of_values(kind: str) -> None:
    robot = robot_of(kind)
    q = places(robot)[2::2]
    steps = 1e-6 * np.eye(q[0].size).reshape(-1, *q[0].shape)
    for own in q[:6]:
        slopes = (robot.drive.values(own + steps) - robot.drive.values(own - steps)).T / 2e-6
        np.testing.assert_allclose(robot.drive.slopes_at(own), slopes, atol=1e-6 * np.abs(slopes).max())


def test_rates_of_lines_that_end_where_nothing_bends_are_refused() -> None:
    stiff = sn.Segment(20.0, max_bend=0.0, tendons=sn.Tendons(angles=[0.0, 2.0], radius=4.0, stiffness=50.0))
    robot = sn.Robot([sn.Segment(60.0, stiffness=2000.0), stiff])
    held = robot.from_actuators([0.1, 0.0])
    refused("rates.actuator", lambda: sn.plan(robot, held, robot.straight, rates=sn.Rates(actuator=1.0)))
