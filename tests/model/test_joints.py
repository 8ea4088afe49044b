"""Joints before the first segment, held against matrix exponentials."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

import sinuous as sn
from sinuous.model.joints import Fixed, Joint
from tests.helpers import Floats, random_pose, random_unit, refused, refused_each, skew, twist_matrix

BODY: list[Any] = [{"from": [0.1, 0.0, 0.2], "to": [0.3, -0.2, 0.1], "radius": 0.05}, ((0, 0, 0), (0, 0, 0), 0.1)]


def moved(joint: Joint, value: float) -> Floats:
    """Pose of the link after a joint in the frame of the link before it: a matrix exponential."""
    twist = np.zeros((4, 4))
    if isinstance(joint, sn.Revolute):
        twist[:3, :3] = skew(joint.axis)
    elif isinstance(joint, sn.Prismatic):
        twist[:3, 3] = joint.axis
    return np.asarray(joint.origin @ expm(value * twist))


def robots(count: int = 6) -> Iterator[tuple[sn.Robot, Floats, Floats]]:
    """Robots with joints of all kinds, values of their joints, and configurations of their segments."""
    rng = np.random.default_rng(5)
    for trial in range(count):
        joints: list[Joint] = []
        for _ in range(5):
            origin, axis = random_pose(rng), random_unit(rng)
            body = BODY if rng.random() < 0.5 else []
            low, high = np.sort(rng.uniform(-2.0, 2.0, 2)).tolist()
            kind = rng.integers(3)
            if kind == 2:
                joints.append(Fixed(origin, body=body))
            else:
                joints.append((sn.Revolute, sn.Prismatic)[kind](axis, (low, high), origin, body=body))
        moving = [joint.limits for joint in joints if not isinstance(joint, Fixed)]
        if not moving:
            continue
        segments = [sn.Segment((0.2, 0.5), radius=0.02), sn.Segment(0.4)][: 2 if trial else 1]
        robot = sn.Robot(segments, joints=joints, base=random_pose(rng), tool=random_pose(rng))
        q = np.concatenate([rng.uniform(-1, 1, (len(segments), 2)), [[0.3], [0.4]][: len(segments)]], axis=1)
        yield robot, rng.uniform(*np.transpose(moving)), q


def test_the_tip_is_the_product_of_exponentials() -> None:
    for robot, joints, q in robots():
        values, pose = iter(joints.tolist()), robot.base
        for joint in robot.joints:
            pose = pose @ moved(joint, 0.0 if isinstance(joint, Fixed) else next(values))
        first = pose
        for one in q:
            pose = pose @ expm(twist_matrix(one))
        np.testing.assert_allclose(robot.tip(q, joints), pose @ robot.tool, atol=1e-13)
        whole = robot.with_joints(q, joints)
        np.testing.assert_allclose(robot.tip(whole + 1e-17), pose @ robot.tool, atol=1e-13)  # rounding moves nothing
        np.testing.assert_array_equal(robot.tip(whole), robot.tip(q, joints))
        ends = robot.forward(q, joints)
        assert len(ends) == len(robot) == len(whole)
        np.testing.assert_allclose(ends[-1] @ robot.tool, robot.tip(whole), atol=1e-15)
        np.testing.assert_allclose(ends[-len(q) - 1], first, atol=1e-13)
        points = robot.backbone(q, 4, joints)
        np.testing.assert_allclose(points[-1 - 4 * (len(q) - 1)], ends[-len(q), :3, 3], atol=1e-13)


def test_configurations_are_put_together_and_taken_apart() -> None:
    for robot, joints, q in robots():
        many = np.stack([joints, joints + 0.1, joints])
        whole = robot.with_joints(q, many)
        assert whole.shape == (3, len(robot), 3)
        values, arcs = robot.split(whole)
        np.testing.assert_allclose(values, many, atol=1e-15)
        np.testing.assert_array_equal(arcs, np.broadcast_to(q, (3, *q.shape)))
        np.testing.assert_array_equal(robot.configuration("initial", (joints, q)), robot.with_joints(q, joints))
        assert robot.excess(robot.with_joints(q, joints)) == 0.0
        named = dict(reversed([*zip(robot.joint_names, joints.tolist(), strict=True)]))
        np.testing.assert_array_equal(robot.configuration("initial", (named, q)), robot.with_joints(q, named))
        np.testing.assert_array_equal(robot.with_joints(q, named), robot.with_joints(q, joints))
    alone, values = sn.Robot(joints=[sn.Revolute(), sn.Prismatic()]), np.full((4, 2), 0.3)
    whole = alone.with_joints(None, values)
    assert whole.shape == (4, len(alone), 3)
    np.testing.assert_array_equal(alone.tip(None, values), alone.tip(whole))


def test_a_robot_without_joints_takes_its_configuration_alone() -> None:
    robot = sn.Robot.uniform(2, 1.0)
    q = np.array([[0.1, 0.2, 1.0], [0.3, 0.0, 1.0]])
    np.testing.assert_array_equal(robot.tip(q, []), robot.tip(q))
    values, arcs = robot.split(q)
    assert values.shape == (0,)
    np.testing.assert_array_equal(arcs, q)
    assert robot.joint_names == ()


ARM = sn.Robot([sn.Segment(1.0), sn.Segment(1.0)], joints=[sn.Revolute(name="roll"), sn.Prismatic(limits=(0, 1))])
Q = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])


def test_shapes_that_do_not_fit_are_refused() -> None:
    rows = len(ARM)
    said = rf"q: shape \(2, 3\); expected finite numbers of shape \(..., {rows}, 3\), or \(..., 2, 3\) with joints"
    with pytest.raises(sn.InputError, match=said):
        ARM.tip(Q)
    refused_each("joints", [[1.0], 1.0, [[1.0]], [np.nan, 0.0], "j"], lambda value: ARM.tip(Q, value))
    refused("q", lambda: ARM.tip(Q[:1], [0, 0]), "(..., 2, 3)")
    refused("q", lambda: ARM.with_joints(None, [0, 0]))
    refused("joints", lambda: ARM.tip(np.stack([Q, Q, Q]), np.zeros((2, 2))), "broadcast")
    refused("initial.joints", lambda: ARM.configuration("initial", ([0.0], Q)))
    refused("joints", lambda: sn.Robot.uniform(2, 1.0).tip(Q, [0.5]))
    refused(
        "joints", lambda: ARM.tip(Q, {"rol": 0.1, "j2": 0.0}), "no joint is called 'rol'; expected some of roll, j2"
    )
    refused("joints", lambda: ARM.tip(Q, {"roll": 0.1}), "a value for each: j2")


def test_joints_that_cannot_be_are_refused() -> None:
    refused("axis", lambda: sn.Revolute((0, 0, 0)))
    refused("limits", lambda: sn.Prismatic(limits=(1, 0)), "lower limit above")
    refused("origin.matrix", lambda: sn.Revolute(origin=np.ones((4, 4))))
    refused("rate", lambda: sn.Revolute(rate=0))
    refused_each("body[0]", [[3], [{"from": (0, 0, 0)}], [(1, 2)]], lambda value: sn.Revolute(body=value))
    refused("body[0].radius", lambda: sn.Revolute(body=[((0, 0, 0), (0, 0, 1), 0)]))
    refused("body[0].color", lambda: sn.Revolute(body=[{**BODY[0], "color": 3}]))
    refused("body[0].form", lambda: sn.Revolute(body=[{"form": 3}]), "from")
    refused("joints[1].touches[0]", lambda: sn.Robot(joints=[sn.Revolute(name="a"), sn.Revolute(touches=["b"])]))
    refused("joints[1].name", lambda: sn.Robot(joints=[sn.Revolute(name="a"), sn.Revolute(name="a")]), "joints[0]")
    refused("segments[0].name", lambda: sn.Robot([sn.Segment(1)], joints=[sn.Revolute(name="s1")]), "joints[0]")
    nothing: tuple[Any, ...] = 3, {"revolute": {}}, lambda: 0
    refused_each("joints[0]", nothing, lambda value: sn.Robot(joints=[value]))
    refused("segments", lambda: sn.Robot(joints=[]))


def test_tendons_do_not_run_through_joints() -> None:
    arm = sn.Robot([sn.Segment(1.0, tendons=sn.Tendons(3, 0.1))], joints=[sn.Revolute((1, 0, 0)), sn.Revolute()])
    alone = sn.Robot([sn.Segment(1.0, tendons=sn.Tendons(3, 0.1))])
    q = np.array([[0.4, -0.2, 1.0]])
    whole = arm.with_joints(q, [0.5, -0.7])
    np.testing.assert_allclose(arm.to_actuators(whole), alone.to_actuators(q), atol=1e-15)
    assert arm.undetermined == ("joint 'j1'", "joint 'j2'")
    assert not arm.notes
    again = arm.from_actuators(arm.to_actuators(whole), whole)
    np.testing.assert_allclose(again, whole, atol=1e-12)


def test_links_that_overlap_nearly_everywhere_are_noted() -> None:
    ball = [((0, 0, 0), (0, 0, 0), 0.1)]
    far, near = ((0, 0, 1), (0, 0, 0.01))

    def robot(place: tuple[float, float, float], touches: tuple[str, ...] = ()) -> sn.Robot:
        joints = [sn.Revolute((1, 0, 0), (-1, 1), place, body=ball) for _ in range(2)]
        return sn.Robot(joints=[*joints, sn.Revolute(origin=place, body=ball, touches=touches)])

    assert robot(far).notes == ()
    said = "links of j1 and j3 overlap in 100 of 100 random configurations: `touches` of j3, or an SRDF, allows it"
    assert robot(near).notes == (said,)
    assert robot(near, ("j1",)).notes == ()


LINKED = sn.Robot(
    [sn.Segment(1.0), sn.Segment((0.5, 1.0))],
    joints=[sn.Revolute(name="roll", limits=(-1, 1)), sn.Prismatic((1, 0, 0), (2, 3), name="feed", body=BODY)],
)


def test_numbers_count_segments_and_joints_have_names() -> None:
    assert LINKED.segment_names == ("s1", "s2")
    q = LINKED.with_joints([[0, 0, 1.0], [0, 0, 1.2]], [1.5, 1.75])
    said = [(kind, which, round(amount, 12)) for kind, which, amount in LINKED.violations(q)]
    assert sorted(said, key=str) == [("bend", "roll", 0.5), ("length", "feed", 0.25), ("length", 2, 0.2)]
    held = {
        (each.key, each.value, each.limit)
        for each in LINKED.limit_set.sides(q)
        if each.key.startswith("limits") and not each.fixed
    }
    assert held == {(f"limits[{i}]", *each) for i in (0, 1) for each in ((1.5, (-1, 1)[i]), (1.75, (2, 3)[i]))}
    refused("segment", lambda: LINKED.jacobian(q, 3), "from 1 to 2")
    np.testing.assert_array_equal(LINKED.jacobian(q, 2), LINKED.jacobian(q, "s2"))


def test_clearances_are_those_of_segments_and_links_keep_the_least() -> None:
    arm = LINKED.changed(clearance=[0.2, 0.1], self_clearance={"s2": 0.4}, uncertainty=sn.Uncertainty([0.03, 0.02]))
    before = len(arm) - 2
    np.testing.assert_allclose(np.subtract(arm.needed_radii, arm.radii), [0.12] * before + [0.23, 0.12])
    np.testing.assert_allclose(np.subtract(arm.self_radii, arm.radii), [0.0] * before + [0.0, 0.2])
    assert arm.clearance == (0.2, 0.1)


def test_actuators_see_joints_first_then_segments() -> None:
    rng = np.random.default_rng(3)
    weights, gain = rng.normal(size=(3, 8)), np.array([2.0, -3.0, 1.0])
    arm = LINKED.changed(actuators=sn.Actuators(weights, gain=gain, offset=[1.0, 0.0, -4.0]))
    joints, q = np.array([0.4, 2.5]), np.array([[0.1, -0.3, 1.0], [0.2, 0.3, 0.7]])
    wanted = gain * (weights @ [*joints, *q.ravel()]) + [1.0, 0.0, -4.0]
    np.testing.assert_allclose(arm.to_actuators((joints, q)), wanted, atol=1e-12)
    np.testing.assert_allclose(arm.actuator_jacobian((joints, q)), gain[:, None] * weights, atol=1e-12)
    found = arm.from_actuators(wanted, (joints, q))
    np.testing.assert_allclose(found, arm.with_joints(q, joints), atol=1e-12)
    motor = LINKED.changed(actuators=sn.Actuators([[0, 1, *[0] * 6]], limits=(200, 300), gain=100.0, names=["m"]))
    assert motor.excess(([0.0, 2.5], q)) == 0.0
    assert motor.excess(([0.0, 3.25], q)) == pytest.approx(0.25)
    refused("actuators", lambda: LINKED.changed(actuators=sn.Actuators(np.ones((1, 6)))), "8: one a joint")


def test_velocities_and_lists_of_pairs_are_taken() -> None:
    q = np.array([[0.1, 0.2, 1.0], [0.0, 0.1, 0.7]])
    pairs = [(np.array([0.1, 2.2]), q), (np.array([0.2, 2.4]), q)]
    both = np.stack([LINKED.with_joints(arcs, joints) for joints, arcs in pairs])
    np.testing.assert_array_equal(LINKED.configuration("q", pairs), both)
    moved = LINKED._one_velocity("velocity", ([0.1, 0.2], 0.0 * q))
    np.testing.assert_allclose(moved, both[1] - both[0], atol=1e-15)


def test_joints_that_stand_in_one_place_have_a_unit_of_length() -> None:
    joints = [sn.Revolute((0, 0, 1)), sn.Revolute((0, 1, 0))]
    assert sn.solve(sn.Robot(joints=joints), sn.Target(direction=(1.0, 0.0, 1.0))).solved
    pointer = sn.Robot(joints=joints, tool=sn.pose((0.1, 0.0, 0.2)))
    assert pointer.mean_length == pytest.approx(math.hypot(0.1, 0.2))
    assert pointer.notes == ()
    assert sn.solve(pointer, sn.Target((0.2, 0.0, -0.1))).solved


def test_what_is_brought_within_limits_keeps_its_prismatic_joints() -> None:
    """Bends that rounding left in the row of one made a revolute joint of it, without any displacement."""
    joints = [sn.Revolute((0, 1, 0.3)), sn.Prismatic((0, 0, 1), limits=(0.0, 0.1))]
    lines = sn.Tendons(4, 0.004, displacement=(-0.004, 0.004))
    robot = sn.Robot([sn.Segment((0.06, 0.13), 2.5, tendons=lines)] * 2, joints=joints)
    for q in np.random.default_rng(2).normal(0.05, 0.5, (20, len(robot), 3)):
        found = robot.clamp(q)
        values, arcs = robot.split(found)
        np.testing.assert_allclose(robot.tip(found), robot.tip((values, arcs)), atol=1e-12)
