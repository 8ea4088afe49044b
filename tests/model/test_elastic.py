"""Elastic actuators: shapes of least energy, the least tensions of a shape, and what cannot be."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog, minimize

import sinuous as sn
from tests.helpers import Floats, refused, refused_each


def arm(count: int = 3, lengths: tuple[float, ...] = (60.0, 62.5, 64.0), **tendons: Any) -> sn.Robot:
    """A tendon robot whose segments differ."""
    return sn.Robot(
        [
            sn.Segment(
                length,
                tendons=sn.Tendons(count, 4.5 - 0.2 * k, 0.4 * k, stiffness=1.0 + 0.3 * k, **tendons),
                stiffness=sn.Stiffness(400.0 - 50.0 * k),
                rest=(0.1, -0.05 * k),
            )
            for k, length in enumerate(lengths)
        ]
    )


def drawn(robot: sn.Robot, count: int, spread: float = 0.8) -> Floats:
    q = np.random.default_rng(3).normal(0.0, spread, (count, len(robot), 3))
    q[..., 2] = [segment.length[0] for segment in robot.segments]
    return q


def driven(robot: sn.Robot) -> list[tuple[sn.Segment, sn.Tendons]]:
    return [(segment, segment.tendons) for segment in robot.segments if segment.tendons is not None]


def held(robot: sn.Robot, q: Floats) -> Floats:
    """Moments (6,) with which the segments of `arm` resist."""
    stiff = [0.0 if segment.stiffness is None else segment.stiffness.bend for segment in robot.segments]
    own = zip(robot.segments, stiff, q, strict=True)
    return np.ravel([k / segment.length[0] * (row[:2] - segment.rest) for segment, k, row in own])


def energy(robot: sn.Robot, q: Floats, values: Floats) -> float:
    """What the shape that tendons pull a robot into has least of; written out one by one."""
    total, at = 0.0, 0
    for k, segment in enumerate(robot.segments):
        assert segment.stiffness is not None
        assert segment.tendons is not None
        total += segment.stiffness.bend / segment.length[0] * float(((q[k, :2] - segment.rest) ** 2).sum()) / 2.0
        bend = q[: k + 1, :2].sum(axis=0)
        for angle, stiff in zip(segment.tendons.angles, segment.tendons.stiffnesses, strict=True):
            toward = segment.tendons.radius * np.array([math.cos(angle), math.sin(angle)])
            total += stiff * max(0.0, values[at] - float(toward @ bend)) ** 2 / 2.0
            at += 1
    return total


@pytest.mark.parametrize("count", [3, 4, 6])
def test_what_a_shape_needs_makes_that_shape(count: int) -> None:
    robot = arm(count)
    q = drawn(robot, 200)
    values = robot.to_actuators(q)
    np.testing.assert_allclose(robot.from_actuators(values), q, atol=1e-12)
    assert robot.tensions(values).min() >= -1e-12


def test_any_values_make_a_shape_whose_own_values_make_it_again() -> None:
    robot = arm()
    values = np.random.default_rng(1).normal(0.0, 6.0, (300, 9))
    q = robot.from_actuators(values)
    np.testing.assert_allclose(robot.from_actuators(robot.to_actuators(q)), q, atol=1e-12)
    assert robot.drive.excess(q).max() < 1e-12


def test_the_shape_has_least_energy() -> None:
    robot = arm()
    for values in np.random.default_rng(2).normal(0.0, 5.0, (5, 9)):
        q = robot.from_actuators(values)

        def of_bends(bends: Floats, values: Floats = values, q: Floats = q) -> float:
            return energy(robot, np.column_stack([bends.reshape(3, 2), q[:, 2]]), values)

        least = minimize(of_bends, np.zeros(6), method="BFGS", options={"gtol": 1e-9})
        np.testing.assert_allclose(q[:, :2].ravel(), least.x, atol=2e-7)


def test_tensions_are_the_least_that_hold_the_shape() -> None:
    robot = arm(tension=(0.5, None))
    for q in drawn(robot, 4):
        values = robot.to_actuators(q)
        tensions = robot.tensions(values)
        assert tensions.min() == pytest.approx(0.5)
        arms = robot.drive.jacobian.reshape(9, 3, 3)[:, :, :2].reshape(9, 6)
        least = linprog(np.ones(9), A_eq=arms.T, b_eq=held(robot, q), bounds=[(0.5, None)] * 9)
        np.testing.assert_allclose(tensions, np.array(least.x), atol=1e-7)


def test_slack_tendons_are_named() -> None:
    robot = arm()
    values = np.array([3.0, -9.0, -9.0] + [-9.0] * 6)
    assert robot.slack(values) == tuple(each.name for each in robot.actuators[1:])
    assert robot.tensions(values)[0] > 0.0
    free = robot.from_actuators(np.full(9, -50.0))
    np.testing.assert_allclose(free[:, :2], [segment.rest for segment in robot.segments], atol=1e-12)


def test_limits_of_tension_and_displacement_hold_together() -> None:
    robot = arm(tension=(0.0, 3.0), displacement=(-2.0, 4.0))
    arms = robot.drive.jacobian.reshape(9, 3, 3)[:, :, :2].reshape(9, 6)
    possible = 0
    for q in drawn(robot, 120, 0.25):
        stiffness = np.concatenate([tendons.stiffnesses for _, tendons in driven(robot)])
        rigid = arms @ q[:, :2].ravel()
        bounds = [(max(0.0, k * (-2.0 - d)), min(3.0, k * (4.0 - d))) for k, d in zip(stiffness, rigid, strict=True)]
        there = all(low <= high for low, high in bounds)
        there = there and linprog(np.zeros(9), A_eq=arms.T, b_eq=held(robot, q), bounds=bounds).status == 0
        assert (not robot.violations(q)) == there
        possible += there
        if there:
            values = robot.to_actuators(q)
            assert values.min() >= -2.0 - 1e-12
            assert values.max() <= 4.0 + 1e-12
            np.testing.assert_allclose(robot.from_actuators(values), q, atol=1e-12)
    assert 10 < possible < 110


def test_chambers_push_and_pull() -> None:
    segment = sn.Segment((40.0, 80.0), chambers=sn.Chambers(3, 12.0, stiffness=5.0, gain=2.0), stiffness=3000.0)
    robot = sn.Robot([segment, segment])
    q = drawn(robot, 30)
    q[..., 2] = np.random.default_rng(0).uniform(45.0, 75.0, q.shape[:2])
    np.testing.assert_allclose(robot.from_actuators(robot.to_actuators(q)), q, atol=1e-11)
    pushed = robot.tensions(2.0 * np.array([62.0, 60.0, 60.0, 60.0, 60.0, 60.0]))
    assert pushed[0] * pushed[1] < 0.0
    assert robot.from_actuators(2.0 * np.full(6, 66.0))[0] == pytest.approx([0.0, 0.0, 66.0])


def test_what_cannot_be_is_refused() -> None:
    tendons = sn.Tendons(3, 1.0, stiffness=2.0)
    refused(
        "segments[1].stiffness", lambda: sn.Robot([sn.Segment(1.0, stiffness=1.0), sn.Segment(1.0, tendons=tendons)])
    )
    rigid = sn.Segment(1.0, tendons=sn.Tendons(3, 1.0), stiffness=1.0)
    refused("segments[0]", lambda: sn.Robot([rigid, sn.Segment(1.0, tendons=tendons, stiffness=1.0)]), "rigid")
    refused_each("stiffness", (0.0, -1.0, math.nan, "soft", [1.0, 2.0]), lambda k: sn.Tendons(3, 1.0, stiffness=k))
    refused("stiffness[1]", lambda: sn.Tendons(3, 1.0, stiffness=[1.0, -2.0, 1.0]))
    refused("tension", lambda: sn.Tendons(3, 1.0, tension=(0.0, 1.0)), "stiffness")
    refused("tension[0]", lambda: sn.Tendons(3, 1.0, stiffness=1.0, tension=(-1.0, 1.0)), "at least 0")
    refused_each("stiffness", (0.0, -1.0, math.nan, "soft"), lambda k: sn.Segment(1.0, stiffness=k))
    refused("rest", lambda: sn.Segment(1.0, rest=(1.0,)))
    two: Any = np.zeros((2, 9))
    refused("actuators", lambda: arm().slack(two))


def test_two_tendons_hold_a_plane_only() -> None:
    robot = sn.Robot([sn.Segment(50.0, tendons=sn.Tendons(2, 2.0, stiffness=3.0), stiffness=50.0)])
    inside, across = np.array([[0.4, 0.0, 50.0]]), np.array([[0.0, 0.4, 50.0]])
    assert robot.violations(inside) == []
    ((kind, segment, amount),) = robot.violations(across)
    assert (kind, segment) == ("bend", 1)
    assert amount == pytest.approx(0.4)
    np.testing.assert_allclose(robot.from_actuators(robot.to_actuators(inside)), inside, atol=1e-13)


def test_what_no_tension_holds_is_not_solved() -> None:
    loose = arm()
    tight = arm(tension=(0.0, 1.2))
    positions = loose.forward(drawn(loose, 40, 0.3))[:, -1, :3, 3]
    for position in positions[:15]:
        solution = sn.solve(tight, sn.Target(position), time=0.2)
        assert not (solution.solved and tight.violations(solution.q))
        if solution.solved:
            assert solution.actuators is not None
            assert solution.tensions is not None
            assert solution.to_dict()["tensions"] == solution.tensions
            np.testing.assert_allclose(list(solution.tensions.values()), tight.tensions(solution.actuators), atol=1e-12)
            assert tight.tensions(list(solution.actuators.values())).max() <= 1.2 + 1e-9
    many = sn.Solver(tight, time=0.05).solve_many(positions=positions)
    assert many.solved.any()
    assert all(not tight.violations(q) for q in many.q[many.solved])
