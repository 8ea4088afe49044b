"""Free, driven and locked coordinates: what actuators leave, what files say, and what limits say of it."""

import math
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.files.nouns import read_robot
from sinuous.kernels.tables import HOME
from tests.helpers import refused

FREE = sn.Robot([sn.Segment((0.8, 1.2), 2.0, name="s1"), sn.Segment(1.0, 1.5, name="tip")])


def drawn(robot: sn.Robot, count: int = 20, seed: int = 0) -> Any:
    """Shapes of all kinds, brought within the limits of segments."""
    rng = np.random.default_rng(seed)
    q = rng.normal(size=(count, len(robot), 3)) + np.array([0.0, 0.0, 1.0])
    return robot.drive.coordinates.project(q)


@pytest.mark.parametrize(
    ("robot", "said"),
    [
        (FREE.locked({"s1": (0.3, None, 0.9), 2: (0.1, -0.2, None)}), ("bend_x is locked at 0.3", "length is locked")),
        (sn.Robot([sn.Segment((0.5, 1.0), (-0.3, 1.2), plane=0.7)]), ("bends in one plane, at 0.7 rad",)),
        (sn.Robot([sn.Segment(1.0, 0.0, rest=(0.4, 0.1))]), ("locked at its rest, (0.4, 0.1)",)),
        (sn.Robot([sn.Segment(1.0, 2.0, rest=(0.1, 0.2), tendons=sn.Tendons(2, 0.1, 0.5))]), ("in one plane, at 0.5",)),
        (sn.Robot([sn.Segment(1.0, tendons=sn.Tendons(3, 0.1)), sn.Segment(1.0, rest=(0.2, 0.0))]), ("no actuator",)),
    ],
)
def test_what_is_held_is_said_and_its_file_makes_an_equal_robot(robot: sn.Robot, said: tuple[str, ...]) -> None:
    assert all(any(each in note for note in robot.notes) for each in said)
    assert read_robot(robot.to_dict()).equals(robot)
    assert robot.undetermined == robot.changed(name="other").undetermined
    q = drawn(robot)
    assert robot.excess(q) <= 1e-15
    assert max(robot.excess(each + np.array([0.3, -0.2, 0.4])) for each in q) > 0.05


def test_passive_stiff_segments_stay_at_rest_beside_elastic_tendons() -> None:
    pulled = sn.Segment(1.0, 2.0, stiffness=1.0, tendons=sn.Tendons(3, 0.1, stiffness=100.0))
    robot = sn.Robot([pulled, sn.Segment(1.0, 2.0, stiffness=1.0, rest=(0.2, 0.1))])
    q = np.array([[0.5, -0.3, 1.0], [0.2, 0.1, 1.0]])
    np.testing.assert_allclose(robot.from_actuators(robot.to_actuators(q)), q, atol=1e-12)
    assert robot.undetermined == ()
    assert robot.violations(q) == []
    assert [each[:2] for each in robot.violations(q + np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]]))] == [("bend", 2)]


def test_equal_limits_lock_what_they_see_of_one_segment() -> None:
    rows = np.eye(6)[[0, 1, 3, 4]]
    robot = sn.Robot.uniform(2, 1.0, 2.0, actuators=sn.Actuators(rows, limits=[(0.5, 0.5), None, (0, 0), (0.1, 0.1)]))
    line, point = robot.drive.coordinates.bends
    assert (line.rest, line.plane) == ((0.5, 0.0), (0.0, 1.0))  # type: ignore[union-attr]
    assert point.at(0.0) == (0.0, 0.1)  # type: ignore[union-attr]
    assert len(robot.actuation) == 0
    refused(
        "segments[0]", lambda: sn.Robot.uniform(1, 1.0, 2.0, actuators=sn.Actuators([[1, 0, 0]], limits=(3, 3))), "own"
    )


def test_planes_turn_with_the_base() -> None:
    """A robot whose planes are turned by an angle is the robot with a base that is turned by it."""
    rng, angle = np.random.default_rng(3), 0.9
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[cosine, -sine, 0, 0], [sine, cosine, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    planes = [sn.Segment(1.0, (-1.0, 1.5), plane=0.2), sn.Segment((0.5, 1.0), 1.0, plane=1.1)]
    one = sn.Robot(planes, base=turn)
    other = sn.Robot([each.changed(plane=(each.plane or 0.0) + angle) for each in planes])
    q = one.drive.coordinates.project(rng.normal(size=(10, 2, 3)) + np.array([0.0, 0.0, 1.0]))
    turned = q.copy()
    turned[..., :2] = q[..., :2] @ turn[:2, :2].T
    assert other.excess(turned) <= 1e-15
    np.testing.assert_allclose(one.tip(q)[..., :3, 3], other.tip(turned)[..., :3, 3], atol=1e-14)


def stuck(first: float, second: float) -> sn.Robot:
    """A section stuck in a bend before one in a plane: how far the tendons of both may be let out."""
    first_tendons, second_tendons = (sn.Tendons(4, 0.05, displacement=(-out, 0.1)) for out in (first, second))
    stays = sn.Segment((0.8, 1.2), 2.0, tendons=first_tendons, locked=(0.4, None, None))
    return sn.Robot([stays, sn.Segment((0.8, 1.2), 2.0, tendons=second_tendons, plane=0.0)])


def test_home_is_within_all_limits_or_there_is_no_robot() -> None:
    for second, bend, length in ((0.025, 0.0, -1.0), (0.015, -0.1, 1.0)):
        robot = stuck(0.025, second)
        home = robot.limits[:, HOME : HOME + 3]
        np.testing.assert_allclose(home, [[0.4, 0.0, length], [bend, 0.0, length]], atol=1e-9)
        assert robot.excess(home * [1.0, 1.0, length]) <= 1e-11
    refused("actuators", lambda: stuck(0.015, 0.025), "no shape is within their limits", "wider limits")


def test_what_cannot_be_meant_is_refused() -> None:
    refused("max_bend", lambda: sn.Segment(1.0, (0.0, 1.0)), "a pair without a plane")
    refused("locked", lambda: sn.Segment(1.0, locked=(0.0, 0.0)), "[bend_x, bend_y, length]")
    refused("locked[2]", lambda: sn.Segment((1.0, 2.0), locked=(None, None, 3.0)), "outside the limits")
    refused("locked", lambda: sn.Segment(1.0, 0.5, locked=(0.6, None, None)), "at most 0.5 rad")
    refused("segments[0]", lambda: sn.Robot([sn.Segment(1.0, 4.0, 1.0, locked=(2.0, 0.0, None))]), "beyond its limit")
    refused("coordinates", lambda: FREE.locked({"s9": None}), "s9")
    assert FREE.locked({"s1": (0.1, 0.2, 1.0)}).locked({"s1": None}).equals(FREE)
