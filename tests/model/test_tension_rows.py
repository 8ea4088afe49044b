"""Rows of tension limits: they say what the least tensions of a shape say, and bound all of a way between shapes."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.measures.statics import lacking_stretch
from tests.helpers import present, refused

TENDONS: dict[str, Any] = {"tension": (0.0, 6.0)}
ROBOTS: dict[str, tuple[Any, dict[str, Any]]] = {
    "three tendons": (60.0, {"tendons": sn.Tendons(3, 4.0, 0.3, stiffness=50.0, **TENDONS)}),
    "four taut tendons": (60.0, {"tendons": sn.Tendons(4, 4.0, stiffness=50.0, tension=(1.0, 8.0))}),
    "two tendons": (60.0, {"tendons": sn.Tendons(2, 4.0, stiffness=50.0, **TENDONS)}),
    "displacements": (60.0, {"tendons": sn.Tendons(3, 4.0, stiffness=50.0, displacement=(-2.0, 2.0), **TENDONS)}),
    "lengths": ((40.0, 80.0), {"tendons": sn.Tendons(3, 4.0, stiffness=50.0, **TENDONS)}),
    "chambers": ((50.0, 70.0), {"chambers": sn.Chambers(3, 4.0, stiffness=50.0, tension=(-3.0, 3.0))}),
}


def robot_of(kind: str) -> sn.Robot:
    length, lines = ROBOTS[kind]
    return sn.Robot([sn.Segment(length, max_bend=2.5, stiffness=2000.0, rest=(0.1, 0.0), **lines) for _ in range(2)])


def drawn(robot: sn.Robot, count: int, spread: float) -> Floats:
    random = np.random.default_rng(7)
    low, high = np.array([segment.length for segment in robot.segments]).T
    q = np.empty((count, len(robot), 3))
    q[..., :2], q[..., 2] = random.normal(0.0, spread, (count, len(robot), 2)), random.uniform(low, high, q.shape[:2])
    q[::2, :, :2] = q[::2, :, :2] * [1.0, 0.0] + [0.1, 0.0]  # two tendons hold a plane alone
    return q


@pytest.mark.parametrize("kind", ROBOTS)
def test_rows_say_what_the_least_tensions_say(kind: str) -> None:
    robot = robot_of(kind)
    q, elastic = robot.drive.coordinates.project(drawn(robot, 200, 0.5)), robot.drive.elastic
    assert elastic is not None
    excess = np.maximum(0.0, elastic.rows.excess(q).max(axis=1))
    np.testing.assert_allclose(excess, np.maximum(0.0, elastic.balance(q).short.max(axis=1)), atol=1e-12)
    assert 0 < (excess < 1e-12).sum() < 200
    lacking = [lacking_stretch(robot, one) for one in q[:30]]
    assert [lack > 1e-7 for lack in lacking] == (excess[:30] > 1e-7).tolist(), "a linear program says something else"
    held = q[:30][np.isfinite(lacking)]
    assert lacking_stretch(robot, held) == pytest.approx(max(filter(np.isfinite, lacking), default=0.0), abs=1e-9)


def test_a_plane_holds_what_tendons_would_bend_out_of_it() -> None:
    """The judge asked tendons for no moment across a plane that is no axis: it refuted what the robot does."""
    own: dict[str, Any] = {"stiffness": 2000.0, "tendons": sn.Tendons(3, 4.0, stiffness=50.0, tension=(0.0, 6.0))}
    robot = sn.Robot([sn.Segment(60.0, max_bend=2.5, plane=plane, **own) for plane in (0.7, 2.0)])
    elastic = robot.drive.elastic
    assert elastic is not None
    q = robot.drive.coordinates.project(drawn(robot, 60, 0.5))
    held = elastic.balance(q).short.max(axis=1) <= 1e-12
    assert 10 < held.sum() < 50
    assert lacking_stretch(robot, q[held]) <= 1e-9
    assert lacking_stretch(robot, q) > 0.01


@pytest.mark.parametrize("kind", ROBOTS)
def test_slopes_are_those_of_values_and_ways_are_bounded(kind: str) -> None:
    robot = robot_of(kind)
    rows = present(robot.limit_set.tension_rows)
    assert rows.linear == (kind != "lengths")
    q = drawn(robot, 40, 0.5)
    steps = 1e-6 * np.eye(q[0].size).reshape(-1, *q[0].shape)
    slopes = (rows.values(q[0] + steps) - rows.values(q[0] - steps)).T / 2e-6
    np.testing.assert_allclose(rows.slopes(q[0]), slopes, atol=1e-6 * np.abs(slopes).max())
    shares = np.linspace(0.0, 1.0, 33)[:, None, None]
    for one, other in pairwise(q):
        seen = rows.excess((1.0 - shares) * one + shares * other).max(axis=0)
        assert (seen <= rows.most_between(one, other) + 1e-12).all()
        share = rows.share_between(one, other, 1e-9)
        until = (1.0 - share * shares) * one + share * shares * other
        assert share == 0.0 or rows.excess(until).max() <= 1e-9


def test_lines_that_end_where_nothing_bends_have_no_rows() -> None:
    lines = sn.Tendons(angles=[0.0, 2.0], radius=4.0, stiffness=50.0, tension=(0.0, 6.0))
    stiff = sn.Segment(20.0, max_bend=0.0, tendons=lines)
    robot = sn.Robot([sn.Segment(60.0, stiffness=2000.0), stiff])
    rows = present(robot.limit_set.tension_rows)
    assert not rows.decoupled
    held = robot.from_actuators([0.1, 0.0])
    assert rows.share_between(held, held, 1e-9) == 0.0
    refused("tension", lambda: sn.Solver(robot).step(held, [1.0, 0.0, 0.0], 0.1))
