"""A robot as URDF, held against MuJoCo, which loads it and moves its joints."""

from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.files.joint_chain import JointChain
from tests.model.test_limits import OF_SHAPES, outside_of

SEGMENTS = [
    sn.Segment((0, 80), max_bend=0, radius=4, name="stage"),
    sn.Segment((45, 70), max_bend=2.4, radius=4),
    sn.Segment(60, max_bend=2.0, radius=3),
    sn.Segment(50, max_bend=2.0, radius=3),
]
ARM = sn.Robot(SEGMENTS, base=sn.pose((10, 20, 30), direction=(-1, 0, 0)), tool=sn.pose((1, 2, 30)))
TURNING = 4.5
"""More than the sum of all bends of `CONFIGURATIONS`."""


def configurations(count: int) -> Floats:
    rng = np.random.default_rng(3)
    q = np.concatenate(
        [rng.uniform(-1, 1, (count, 4, 2)), np.tile([[33.0], [50.0], [60.0], [50.0]], (count, 1, 1))], -1
    )
    q[:, 0, :2] = 0.0
    return q


def poses(file: Path, chain: JointChain, q: Floats, body: str) -> Floats:
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    found = []
    for values in chain.values(q):
        for name, value in zip(chain.names, values, strict=True):
            data.joint(name).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = data.body(body).xmat.reshape(3, 3), data.body(body).xpos
        found.append(pose)
    return np.stack(found)


def test_the_tip_is_where_the_arm_has_it_the_better_the_more_joints(tmp_path: Path) -> None:
    q = configurations(5)
    true = ARM.forward(q)[:, -1]
    errors = []
    for count in (4, 8, 16):
        chain = ARM.to_urdf(tmp_path / "arm.urdf", count)
        found = poses(tmp_path / "arm.urdf", chain, q, "tip")
        off = np.linalg.norm(found[:, :3, 3] - true[:, :3, 3], axis=1)
        length = q[:, :, 2].sum(axis=1)
        assert (off <= length * TURNING**2 / (12.0 * count**2)).all()
        assert np.linalg.norm(found[:, :3, :3] - true[:, :3, :3], axis=(1, 2)).max() <= TURNING**2 / count**2
        errors.append(off)
    assert (errors[1] <= 0.27 * errors[0]).all()
    assert (errors[2] <= 0.27 * errors[1]).all()


def test_shapes_cover_the_body_from_base_to_tip(tmp_path: Path) -> None:
    """Of the straight arm: cylinders of all radii reach from the base to the tip without a gap."""
    chain = ARM.to_urdf(tmp_path / "arm.urdf", 4)
    q = np.array([[0, 0, 33.0], [0, 0, 50], [0, 0, 60], [0, 0, 50]])
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.urdf"))
    data = mujoco.MjData(model)
    for name, value in zip(chain.names, chain.values(q), strict=True):
        data.joint(name).qpos[0] = value
    mujoco.mj_kinematics(model, data)
    rods = model.geom_type == mujoco.mjtGeom.mjGEOM_CYLINDER
    middles = (data.geom_xpos[rods] - ARM.base[:3, 3]) @ ARM.base[:3, 2]
    low, high = middles - model.geom_size[rods, 1], middles + model.geom_size[rods, 1]
    places = np.linspace(0.0, 193.0, 400)
    assert ((low <= places[:, None] + 1e-9) & (places[:, None] <= high + 1e-9)).any(axis=1).all()
    assert set(model.geom_size[:, 0].round(9)) == {3.0, 4.0}


def test_an_arm_without_a_radius_collides_with_nothing(tmp_path: Path) -> None:
    sn.Robot.uniform(2, 10.0).to_urdf(tmp_path / "thin.urdf")
    root = ElementTree.parse(tmp_path / "thin.urdf").getroot()
    assert root.findall(".//collision") == []
    assert len(root.findall(".//visual")) > 0
    mujoco.MjModel.from_xml_path(str(tmp_path / "thin.urdf"))


@pytest.mark.parametrize("limit", OF_SHAPES)
def test_a_limit_that_joints_do_not_keep_is_named_in_the_file(limit: str, tmp_path: Path) -> None:
    robot, outside, (kind, _) = outside_of(limit)
    urdf, mjcf = tmp_path / "arm.urdf", tmp_path / "arm.xml"
    chain, driven = robot.to_urdf(urdf), robot.to_mjcf(mjcf)
    stopped = beyond(chain.values(outside), [joint.limits for joint in chain.joints])
    held = stopped or beyond(driven.controls(outside), [drive.limits for drive in driven.drives])
    for file, kept in ((urdf, stopped), (mjcf, held)):
        (comment,) = [line for line in file.read_text().splitlines() if "<!--" in line]
        assert kept or ("tension" if limit == "tension" else kind) in comment


def beyond(values: Floats, limits: list[tuple[float, float]]) -> bool:
    low, high = np.transpose(limits)
    return bool(((values < low - 1e-9) | (values > high + 1e-9)).any())
