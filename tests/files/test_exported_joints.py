"""Joints before the first segment in URDF, MJCF and ROS, held against MuJoCo and against reading them again."""

import itertools
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import sinuous as sn
from sinuous.files.joint_chain import JointChain
from sinuous.model.joints import Fixed
from tests.helpers import random_pose, random_unit, refused

RNG = np.random.default_rng(4)
JOINTS = [
    Fixed(random_pose(RNG), name="stand", body=[((0, 0, 0), (0, 0.1, 0.2), 0.05)]),
    sn.Revolute((0, 0, 2), (-2, 2.5), random_pose(RNG), name="pan", body=[((0, 0, 0), (0.3, 0, 0), 0.04)], rate=3),
    sn.Prismatic(random_unit(RNG), (-0.2, 0.5), random_pose(RNG), name="lift"),
    sn.Revolute(random_unit(RNG), (-1, 1), body=[((0, 0, 0), (0, 0, 0), 0.1)]),
    Fixed(random_pose(RNG)),
]
VALUES = np.array([0.7, 0.3, -0.4])
BASE, TOOL = random_pose(RNG), random_pose(RNG)
SEGMENTS = [sn.Segment((0.2, 0.4), 1.5, radius=0.02, tendons=sn.Tendons(3, 0.01)), sn.Segment(0.3, 0, radius=0.02)]
ARM = sn.Robot(SEGMENTS, joints=JOINTS, base=BASE, tool=TOOL)
ALONE = sn.Robot(joints=JOINTS, base=BASE, tool=TOOL)
Q = np.array([[0.3, -0.4, 0.3], [0.0, 0.0, 0.3]])


def placed(file: Path, names: tuple[str, ...], values: Any) -> Any:
    """A simulation with these values of joints."""
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    for name, value in zip(names, values, strict=True):
        data.joint(name).qpos[0] = value
    mujoco.mj_forward(model, data)
    return data


def test_all_joints_are_in_order_with_their_values() -> None:
    chain = JointChain(ARM, 4)
    assert chain.names[:3] == ARM.joint_names == ("pan", "lift", "j4")
    assert chain.names[3:6] == ("s1_1_z", "s1_1_x", "s1_1_y")
    whole = ARM.with_joints(Q, VALUES)
    np.testing.assert_allclose((chain.matrix @ whole.ravel() + chain.offsets)[:3], VALUES, atol=1e-15)


@pytest.mark.parametrize("robot", [ARM, ALONE], ids=["with segments", "without"])
def test_the_tool_is_where_the_robot_has_it(robot: sn.Robot, tmp_path: Path) -> None:
    q = Q if robot is ARM else None
    wanted = robot.tip(q, VALUES)
    chain = robot.to_urdf(tmp_path / "arm.urdf", 32)
    data = placed(tmp_path / "arm.urdf", chain.names, chain.values((VALUES, q)))
    np.testing.assert_allclose(data.body("tool").xpos, wanted[:3, 3], atol=1e-4)
    np.testing.assert_allclose(data.body("tool").xmat.reshape(3, 3), wanted[:3, :3], atol=1e-4)
    driven = robot.to_mjcf(tmp_path / "arm.xml", 32)
    data = placed(tmp_path / "arm.xml", chain.names, chain.values((VALUES, q)))
    np.testing.assert_allclose(data.site("tool").xpos, wanted[:3, 3], atol=1e-4)
    assert driven.names[-3 if robot is ALONE else -4 :][:3] == ("pan", "lift", "j4")


def test_servos_lead_joints_to_their_values(tmp_path: Path) -> None:
    driven = ALONE.to_mjcf(tmp_path / "arm.xml")
    data = mujoco.MjData(model := mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml")))
    data.ctrl[:] = driven.controls((VALUES, None))
    np.testing.assert_allclose(data.ctrl, VALUES, atol=1e-15)
    mujoco.mj_step(model, data, nstep=2500)
    np.testing.assert_allclose(data.qpos, VALUES, atol=1e-6)
    np.testing.assert_allclose(model.body_subtreemass[0], 1.0, rtol=0.01)  # links without a body weigh next to nothing


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    ALONE.to_urdf(tmp_path / "arm.urdf")
    assert "does not keep" not in (tmp_path / "arm.urdf").read_text()  # limits of joints are kept as they are
    again = sn.Robot(joints=sn.read_joints(tmp_path / "arm.urdf", tip="tool"))
    assert again.joint_names == ALONE.joint_names
    moving = [joint for joint in again.joints if not isinstance(joint, Fixed)]
    own = [joint for joint in ALONE.joints if not isinstance(joint, Fixed)]
    assert [(type(joint), joint.limits) for joint in moving] == [(type(joint), joint.limits) for joint in own]
    assert moving[0].rate == 3
    for share in itertools.product((0.1, 0.8), repeat=3):
        values = [low + each * (high - low) for each, (low, high) in zip(share, (j.limits for j in own), strict=True)]
        np.testing.assert_allclose(again.tip(None, values), ALONE.tip(None, values), atol=1e-13)


def test_a_joint_with_the_name_of_a_link_is_refused(tmp_path: Path) -> None:
    robot = sn.Robot(joints=[sn.Revolute(name="tip")])
    refused("joints", lambda: robot.to_urdf(tmp_path / "arm.urdf"), "a URDF has a link of that name already")
