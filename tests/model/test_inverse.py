"""From the values of actuators back to configurations."""

import math
from functools import partial
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import Floats, refused, with_each

DRIVES = ("tendons", "chambers", "both")


def random_robot(rng: np.random.Generator) -> tuple[sn.Robot, bool]:
    """Return a robot of segments of all kinds, and whether its actuators alone determine its configuration."""
    unit = rng.choice([1e-3, 1.0, 1e3])  # m, or mm, or smaller
    parts, determined = [], True
    for _ in range(rng.integers(1, 7)):
        low = rng.uniform(0.2, 1.0) * unit
        length: Any = (low, low + rng.uniform(0.1, 1.0) * unit) if rng.random() < 0.5 else low
        kind = rng.choice(["spacer", "stage", *DRIVES])
        if kind == "spacer":
            parts.append(sn.Segment(low, max_bend=0.0))
            continue
        if kind == "stage":
            parts.append(sn.Segment((0.0, low), max_bend=0.0))
            determined = False
            continue
        lines = rng.integers(3, 7), rng.uniform(0.02, 0.2) * unit, rng.uniform(-3, 3)
        tendons = None if kind == "chambers" else sn.Tendons(int(lines[0]), *lines[1:])
        chambers = None if kind == "tendons" else sn.Chambers(int(lines[0]), *lines[1:])
        parts.append(sn.Segment(length, 3.0, tendons=tendons, chambers=chambers))
        determined &= kind != "tendons" or not isinstance(length, tuple)
    return sn.Robot(parts if parts else [sn.Segment(unit)]), determined


def random_shapes(robot: sn.Robot, rng: np.random.Generator, count: int) -> Floats:
    low, high = np.array([segment.length for segment in robot.segments]).T
    bends = np.array([segment.max_bend for segment in robot.segments])
    q = np.empty((count, len(robot), 3))
    q[..., :2] = rng.normal(size=(count, len(robot), 2)) * bends[:, None]
    q[..., 2] = rng.uniform(low, high, (count, len(robot)))
    return q


def test_there_and_back_for_hundreds_of_robots() -> None:
    rng = np.random.default_rng(0)
    alone = 0
    for _ in range(200):
        robot, determined = random_robot(rng)
        q = random_shapes(robot, rng, 5)
        values = robot.to_actuators(q)
        initial = None if determined else q * [-0.5, 2.0, 1.0]
        scale = np.array([1.0, 1.0, robot.mean_length])
        np.testing.assert_allclose(robot.from_actuators(values, initial) / scale, q / scale, atol=1e-9, rtol=0.0)
        alone += determined
        elsewhere = robot.from_actuators(values, np.ones_like(q))
        np.testing.assert_allclose(robot.to_actuators(elsewhere), values, atol=1e-9 * robot.mean_length)
        if not determined:
            refused("initial", partial(robot.from_actuators, values), "length of s")
    assert 40 < alone < 160


def test_values_that_contradict_each_other_give_the_least_squares() -> None:
    lines = [sn.Tendons(5, 0.05, 0.3 * k) for k in range(3)]
    robot = sn.Robot([sn.Segment(1.0, tendons=each, chambers=sn.Chambers(4, 0.07)) for each in lines])
    values = np.random.default_rng(6).normal(size=(7, len(robot.actuators)))
    moving = np.delete(np.arange(9), [2, 5, 8])
    matrix = robot.actuator_jacobian(np.zeros((3, 3)))
    lengths = np.tile([0.0, 0.0, 1.0], 3)
    expected = np.linalg.lstsq(matrix[:, moving], (values - matrix @ lengths).T)[0].T
    found = robot.from_actuators(values, tolerance=10.0)
    np.testing.assert_allclose(found[..., :2].reshape(7, 6), expected, atol=1e-9)


def test_contradictions_are_answered_with_what_is_left() -> None:
    """Three tendons of one arc are one too many: their displacements add up to zero."""
    tendons = sn.Tendons(3, 5.0, gain=[100.0, -100.0, 40.0], offset=2048.0, unit="counts")
    robot = sn.Robot([sn.Segment(80.0, tendons=tendons)])
    q = np.array([[[0.4, -0.2, 80.0]], [[0.1, 0.3, 80.0]]])
    values = robot.to_actuators(q)
    np.testing.assert_allclose(robot.from_actuators(values + 1e-3), q, atol=1e-5)  # digits of a table
    values[1, 1] -= 30.0  # 0.3 too far, of which a third fits no arc
    with pytest.warns(sn.SuspiciousInput, match=r"is off by (10|4) counts, in row 1; tolerance= says"):
        found = robot.from_actuators(values)
    left = robot.to_actuators(found) - values
    np.testing.assert_allclose(left[1] / [100.0, -100.0, 40.0], -0.1, atol=1e-12)
    np.testing.assert_array_equal(robot.from_actuators(values, tolerance=10.1), found)
    np.testing.assert_array_equal(robot.from_actuators(values, tolerance=[10.1, 10.1, 4.1]), found)
    refused("actuators: s1.t2", lambda: robot.from_actuators(values, tolerance=[99, 9.9, 99]), "10 counts, in row 1")
    refused("actuators: s1.t3", lambda: robot.from_actuators(values[1], tolerance=[99.0, 99.0, 3.0]), "off by 4 counts")
    refused("tolerance", lambda: robot.from_actuators(values, tolerance=-1.0), "at least 0")
    refused("tolerance", lambda: robot.from_actuators(values, tolerance=[1.0]), "one number, or 3")


def test_values_by_name_are_those_in_order() -> None:
    robot = sn.Robot(
        [
            sn.Segment((0.0, 50.0), 0.0, stage=sn.Stage(unit="mm"), name="feed"),
            sn.Segment(80.0, tendons=sn.Tendons(3, 5.0)),
        ]
    )
    q = np.array([[[0, 0, 12.0], [0.3, 0.1, 80.0]], [[0, 0, 20.0], [0.0, -0.4, 80.0]]])
    for shape in (q, q[0]):
        values = robot.to_actuators(shape)
        named = dict(zip([each.name for each in reversed(robot.actuators)], values.T[::-1], strict=True))
        np.testing.assert_allclose(robot.from_actuators(named), shape, atol=1e-12)
    refused(
        "actuators", lambda: robot.from_actuators({"feed": 1.0, "left": 0.0}), "'left'", "feed, s2.t1, s2.t2, s2.t3"
    )
    refused("actuators", lambda: robot.from_actuators({"feed": 1.0}), "a value for each: s2.t1, s2.t2, s2.t3")
    refused("actuators.feed", lambda: robot.from_actuators(named | {"feed": "far"}), "finite")
    refused("actuators", lambda: robot.from_actuators(named | {"feed": [1.0, 2.0]} | {"s2.t1": [0.0] * 3}), "broadcast")


def test_open_coordinates_are_named() -> None:
    pair = sn.Tendons(2, 0.1)
    robot = sn.Robot([sn.Segment(1.0, tendons=pair), sn.Segment((0.5, 1.5), tendons=sn.Tendons(3, 0.1), name="wrist")])
    refused("initial", lambda: robot.from_actuators(np.zeros(5)), "length of wrist (segment 2)")
    sum_only = sn.Robot([sn.Segment(1.0), sn.Segment(1.0, tendons=sn.Tendons(3, 0.1))])
    named = "bend_x of s1 (segment 1), bend_y of s1 (segment 1), bend_x of s2 (segment 2), bend_y of s2"
    refused("initial", lambda: sum_only.from_actuators(np.zeros(3)), named)
    refused("initial", lambda: sn.Robot.uniform(9, 1.0).from_actuators([]), "bend_y of s2 (segment 2) and 14 more")


@with_each("values", [None, 3.0, "abc", [1.0, 2.0], [[1.0, 2.0, 3.0, 4.0]], [1.0, math.nan, 0.0], [True] * 3])
def test_bad_values_are_refused(values: Any) -> None:
    robot = sn.Robot([sn.Segment(1.0, tendons=sn.Tendons(3, 0.1))])
    refused("actuators", lambda: robot.from_actuators(values), "3)")


@with_each("initial", [3.0, "straight", [0.0, 0.0, 1.0], [[0.0, 0.0]], [[0.0, 0.0, math.inf]]])
def test_bad_references_are_refused(initial: Any) -> None:
    robot = sn.Robot([sn.Segment(1.0, tendons=sn.Tendons(3, 0.1))])
    refused("initial", lambda: robot.from_actuators([0.0, 0.0, 0.0], initial), "1, 3)")
