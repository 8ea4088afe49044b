"""The robot: what it says of itself, poses and Jacobians of whole batches, lines and back, limits, and bad input."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from tests.helpers import (
    NOT_NUMBERS,
    Floats,
    complex_columns,
    configurations,
    expm_chain,
    random_pose,
    refused,
    refused_each,
    twist_of,
    with_each,
)


def posed_robot(seed: int, n: int = 4) -> sn.Robot:
    rng = np.random.default_rng(seed)
    return sn.Robot.uniform(n, (0.0, 100.0), 7.0, base=random_pose(rng), tool=random_pose(rng, 0.3))


# Kinematics


@with_each("seed", range(5))
def test_poses_are_products_of_exponentials(seed: int) -> None:
    robot = posed_robot(seed)
    for q in configurations(seed, 4, 10):
        expected = expm_chain(q, robot.base)
        scale = 1.0 + q[:, 2].sum()
        np.testing.assert_allclose(robot.forward(q), expected[1:], atol=1e-13 * scale)
        np.testing.assert_allclose(robot.tip(q), expected[-1] @ robot.tool, atol=1e-13 * scale)


@with_each("lead", [(), (1,), (7,), (2, 3), (0,), (2, 0)])
def test_a_batch_is_its_members_one_by_one(lead: tuple[int, ...]) -> None:
    robot = posed_robot(1)
    count = math.prod(lead)
    q = np.array(configurations(2, 4, count)).reshape(*lead, 4, 3)
    calls: list[tuple[Callable[[Floats], Floats], tuple[int, ...]]] = [
        (robot.forward, (4, 4, 4)),
        (robot.tip, (4, 4)),
        (lambda x: robot.backbone(x, 5), (21, 3)),
        (robot.jacobian, (6, 12)),
        (lambda x: robot.jacobian(x, 2), (6, 12)),
    ]
    for call, shape in calls:
        batch = call(q)
        assert batch.shape == (*lead, *shape)
        np.testing.assert_array_equal(call(np.asfortranarray(q)), batch)
        for index in np.ndindex(*lead):
            np.testing.assert_allclose(batch[index], call(q[index]), rtol=0, atol=1e-12)


@with_each("seed", range(4))
@with_each("segment", [None, 1, 3])
def test_jacobians_are_the_derivatives(seed: int, segment: int | None) -> None:
    robot = posed_robot(seed)

    def end(x: Any) -> Any:
        poses = expm_chain(x, robot.base)
        return poses[-1] @ robot.tool if segment is None else poses[segment]

    for q in configurations(10 + seed, 4, 5):
        J = robot.jacobian(q, segment)
        rates, pose = complex_columns(end, q), end(q)
        for i in range(12):
            twist = twist_of(rates[..., i], pose)
            expected = np.concatenate([twist[:3], rates[:3, 3, i]])
            np.testing.assert_allclose(J[:, i], expected, atol=1e-12 * (1.0 + q[:, 2].sum()))


def test_backbones_are_evenly_spaced_from_base_to_tip() -> None:
    robot = posed_robot(3)
    for q in configurations(3, 4, 10):
        points = robot.backbone(q, 8)
        assert points.shape == (33, 3)
        np.testing.assert_array_equal(points[0], robot.base[:3, 3])
        np.testing.assert_allclose(points[8::8], robot.forward(q)[:, :3, 3], atol=1e-13 * (1 + q[:, 2].sum()))
        for k in range(4):
            steps = np.linalg.norm(np.diff(points[8 * k : 8 * k + 9], axis=0), axis=1)
            bend = np.hypot(*q[k, :2]) / 8
            chord = q[k, 2] / 8 * (math.sin(0.5 * bend) / (0.5 * bend) if bend else 1.0)
            np.testing.assert_allclose(steps, chord, atol=1e-12 * (1 + q[:, 2].sum()))


# Limits


def test_excess_is_how_far_outside_the_limits() -> None:
    robot = sn.Robot(
        [
            sn.Segment((1.0, 2.0), 1.0, max_curvature=0.5),
            sn.Segment(1.0, 0.5, tendons=sn.Tendons(4, 0.1, displacement=(-0.2, 0.1))),
            sn.Segment((0.0, 2.0), chambers=sn.Chambers(3, 0.2, length=(0.5, 1.5))),
        ]
    )
    inside = np.array([[0.5, 0.0, 1.0], [0.0, 0.5, 1.0], [0.0, 0.0, 1.5]])
    assert robot.excess(inside) == 0.0
    for k, i, value, expected in (
        (0, 2, 2.25, 0.25),
        (0, 2, 0.75, 0.25),
        (0, 0, -0.75, 0.25),
        (1, 1, -0.75, 0.25),
        (1, 2, 1.125, 0.125),
        (2, 2, 2.25, 0.75),
        (2, 0, 2.0, 0.2),
    ):
        q = inside.copy()
        q[k, i] = value
        assert robot.excess(q) == pytest.approx(expected), (k, i)
    pulled = np.array([[0.8, 0.0, 2.0], [0.5, 0.0, 1.0], [0.0, 0.0, 1.0]])
    assert robot.excess(pulled) == pytest.approx(0.1 * 1.3 - 0.1)  # the second's tendons run through the first
    assert robot.excess(np.stack([inside, pulled])) == pytest.approx(0.03)
    assert robot.excess(np.zeros((0, 3, 3))) == 0.0


# Tendons and chambers


@with_each("value", NOT_NUMBERS)
def test_bad_numbers_of_segments_are_refused(value: Any) -> None:
    refused("max_bend", lambda: sn.Segment(1.0, value))
    refused("radius", lambda: sn.Segment(1.0, radius=value))
    refused("mount", lambda: sn.Robot([sn.Segment(1.0)], mount=value))
    if value is not None:
        refused("max_curvature", lambda: sn.Segment(1.0, max_curvature=value))
        refused("radius", lambda: sn.Robot([sn.Segment(1.0)], radius=value))
    if value != [1.0]:
        refused("length", lambda: sn.Segment(value))
        refused("length[1]", lambda: sn.Segment((0.0, value)))


def test_limits_that_cannot_be_meant_are_refused() -> None:
    refused("length", lambda: sn.Segment(-1.0), "at least 0")
    refused("length[0]", lambda: sn.Segment((-1.0, 1.0)))
    refused("length", lambda: sn.Segment((2.0, 1.0)), "low <= high")
    refused("length", lambda: sn.Segment((1.0, 2.0, 3.0)))
    refused("max_bend", lambda: sn.Segment(1.0, -0.1))
    refused("max_curvature", lambda: sn.Segment(1.0, max_curvature=-0.1))
    refused("radius", lambda: sn.Segment(1.0, radius=-0.1))
    refused("mount", lambda: sn.Robot([sn.Segment(1.0)], mount=-0.1))
    refused("radius", lambda: sn.Robot([sn.Segment(1.0)], radius=-0.1))
    refused("tendons", lambda: sn.Segment(1.0, tendons=sn.Chambers(3, 0.1)), "Tendons")  # type: ignore[arg-type]
    refused("chambers", lambda: sn.Segment(1.0, chambers={"count": 3}), "Chambers")  # type: ignore[arg-type]


@with_each("value", [0, -1, 2.0, True, "5", None, 10_001, 10**9])
def test_bad_counts_are_refused_at_once(value: Any) -> None:
    refused("count", lambda: sn.Robot.uniform(value, 1.0), "1 to 10000")


def test_what_is_no_robot_is_refused() -> None:
    refused("segments", lambda: sn.Robot([]))
    refused("segments", lambda: sn.Robot([sn.Segment(0.0), sn.Segment((0.0, 0.0))]), "longer than 0")
    refused("segments[1]", lambda: sn.Robot([sn.Segment(1.0), 2.0]), "a Segment")  # type: ignore[list-item]
    refused_each("segments", (None, 5, sn.Segment(1.0)), sn.Robot)
    refused("base.matrix", lambda: sn.Robot([sn.Segment(1.0)], base=np.zeros((4, 4))))
    refused("tool.matrix", lambda: sn.Robot([sn.Segment(1.0)], tool=np.eye(3)))


BAD_CONFIGURATIONS: list[Any] = [
    None,
    3.0,
    "abc",
    [1.0, 2.0, 3.0],
    np.zeros((3, 3)),
    np.zeros((4, 2)),
    np.zeros((4, 3, 4)),
    [[0.0, 0.0, 1.0]] * 3 + [[0.0, 0.0]],
    [[0.0, 0.0, 1.0]] * 3 + [[0.0, 0.0, math.nan]],
    [[0.0, 0.0, 1.0]] * 3 + [[0.0, True, 1.0]],
    [[0.0, 0.0, 1.0]] * 3 + [[0.0, "0", 1.0]],
    [[0.0, 0.0, 1.0]] * 3 + [[0.0, None, 1.0]],
]


@with_each("q", BAD_CONFIGURATIONS)
def test_bad_configurations_are_refused_everywhere(q: Any) -> None:
    robot = posed_robot(0)
    calls: list[Callable[[Any], Any]] = [
        robot.forward,
        robot.tip,
        robot.backbone,
        robot.jacobian,
        robot.excess,
        robot.to_actuators,
        robot.actuator_jacobian,
    ]
    for call in calls:
        refused("q", partial(call, q), "4, 3)")


def test_bad_choices_of_segment_and_samples_are_refused() -> None:
    robot, q = posed_robot(0), configurations(0, 4, 1)[0]
    refused_each("segment", (0, 5, 1.0, True), lambda value: robot.jacobian(q, value), "1 to 4")
    refused("segment", lambda: robot.jacobian(q, "1"), "s1", "no segment is called")
    refused_each("samples", (0, 10**9, 1.5, None), lambda value: robot.backbone(q, value))


@with_each("unit", [1e-9, 1e-3, 1.0, 1e3, 1e9])
def test_limits_hold_to_the_same_share_in_every_unit(unit: float) -> None:
    robot = sn.Robot.uniform(2, (0.8 * unit, 1.2 * unit), 1.0)
    inside = np.array([[0.5, 0.0, 1.2 * unit], [0.0, 1.0, 0.8 * unit]])
    for over, ok in ((0.0, True), (1e-12, True), (1e-7, False), (0.9, False)):
        longer = inside + np.array([[0.0, 0.0, over * unit], [0.0, 0.0, 0.0]])
        bent = inside + np.array([[0.0, 0.0, 0.0], [0.0, over, 0.0]])
        assert (not robot.violations(longer)) is ok
        assert (not robot.violations(bent)) is ok
        for q in (longer, bent):
            assert sn.check(robot, q).ok is ok
