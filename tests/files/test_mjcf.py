"""A robot with its motors as MJCF, held against MuJoCo, which moves it by them.

The shape of a ROS 2 `JointTrajectory`.
"""

import json
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import sinuous as sn
from sinuous.files.joint_chain import joint_trajectory, write_json
from sinuous.files.mjcf import DrivenChain
from tests.helpers import Floats, refused

MIXED = sn.Robot(
    [
        sn.Segment((0, 40), 0, radius=3, name="feed", stage=sn.Stage(gain=-40, offset=9, unit="steps")),
        sn.Segment(10, 0, radius=3),
        sn.Segment(70, 1.5, radius=3, tendons=sn.Tendons(3, 4, displacement=(-6, 6), gain=[100, -50, 2], offset=2048)),
        sn.Segment((40, 70), 1.5, radius=3, chambers=sn.Chambers(3, 4, 0.2, length=(30, 90), gain=2, offset=-7)),
    ],
    base=sn.pose((10, 20, 30), direction=(-1, 0, 1)),
    tool=sn.pose((1, 2, 10), direction=(1, 0, 0)),
    name="arm",
)
LINES = sn.Tendons(3, radius=3, gain=-20)
ROBOTS = {
    "of everything": MIXED,
    "of tendons": sn.Robot.uniform(4, 50.0, 1.2, radius=4, tendons=LINES),
    "huge": sn.Robot.uniform(2, (4.5e5, 7e5), 1.2, radius=4e4, chambers=sn.Chambers(3, radius=3e4)),
    "without motors": sn.Robot.uniform(2, (45, 70), 1.2, radius=4),
    "of one segment": sn.Robot.uniform(1, 50.0, 2.0, tendons=sn.Tendons(2, radius=3)),
    "in planes": sn.Robot(
        [
            sn.Segment(50.0, 2.0, tendons=sn.Tendons(2, radius=3, angle=0.7)),
            sn.Segment(40.0, locked=(0.3, -0.2, None)),
            sn.Segment(50.0, 2.0, rest=(0.0, 0.2), tendons=sn.Tendons(2, radius=3)),
        ]
    ),
    "coupled": sn.Robot(
        [sn.Segment(60, 1.5)] * 2, actuators=sn.Actuators(np.kron([[1, 1], [1, -1]], np.eye(3)[:2]), gain=57.3)
    ),
}


def shape(robot: sn.Robot, seed: int) -> Floats:
    """A configuration well within all limits."""
    rng = np.random.default_rng(seed)
    low, high = np.array([segment.length for segment in robot.segments]).T
    bends = rng.uniform(-0.4, 0.4, (len(robot), 2)) * [[float(s.max_bend > 0)] for s in robot.segments]
    drawn = np.column_stack([bends, rng.uniform(0.8 * low + 0.2 * high, 0.2 * low + 0.8 * high)])
    return robot.drive.coordinates.project(drawn)


def simulated(file: Path) -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return model, data


def joints_of(driven: DrivenChain, data: Any) -> Floats:
    return np.array([data.joint(name).qpos[0] for name in driven.chain.names])


@pytest.mark.parametrize("name", ["of everything", "huge", "of one segment", "in planes", "coupled"])
def test_motors_lead_the_tip_to_where_the_robot_has_it(name: str, tmp_path: Path) -> None:
    """The controls are all that is set; joints, tendons, actuators and the tool follow."""
    robot = ROBOTS[name]
    driven = robot.to_mjcf(tmp_path / "arm.xml", 6)
    model, data = simulated(tmp_path / "arm.xml")
    straight = np.array([(0.0, 0.0, 0.5 * sum(s.length)) for s in robot.segments])
    straight = robot.drive.coordinates.project(straight)  # as near to it as planes and locks allow
    exact = 1e-9 + np.linalg.norm(straight[:, :2], axis=1).sum() ** 2 / (12.0 * 6**2)  # what is bent is a polygon
    away = np.linalg.norm(data.site("tool").xpos - robot.tip(straight)[:3, 3])
    assert away <= exact * straight[:, 2].sum()
    np.testing.assert_allclose(data.actuator_force, 0.0, atol=1e-3 * np.abs(model.actuator_gainprm[:, 0]).max())
    q = shape(robot, 1)
    data.ctrl[:] = driven.controls(q)
    mujoco.mj_step(model, data, nstep=2500)
    wanted = driven.chain.values(q)
    scale = np.where([joint.slides for joint in driven.chain.joints], robot.mean_length, 1.0)
    np.testing.assert_allclose(joints_of(driven, data) / scale, wanted / scale, atol=2e-4)
    off = np.linalg.norm(data.site("tool").xpos - robot.tip(q)[:3, 3])
    turning = np.linalg.norm(q[:, :2], axis=1).sum()
    assert off <= q[:, 2].sum() * (turning**2 / (12.0 * 6**2) + 5e-4)
    assert off < 0.1 * np.linalg.norm(robot.tip(q)[:3, 3] - robot.tip(straight)[:3, 3])
    told = dict(zip(driven.names, data.actuator_length, strict=True))
    for actuator, value in zip(robot.actuators, robot.to_actuators(q), strict=True):
        zero = actuator.gain * constant(driven, actuator.name) + actuator.offset
        assert told[actuator.name] + zero == pytest.approx(value, abs=1e-3 * abs(actuator.gain) * robot.mean_length)


def constant(driven: DrivenChain, name: str) -> float:
    return next(drive.constant for drive in driven.drives if drive.name == name)


def test_what_the_file_has(tmp_path: Path) -> None:
    driven = MIXED.to_mjcf(tmp_path / "arm.xml", 4)
    model, _ = simulated(tmp_path / "arm.xml")
    names = [model.actuator(i).name for i in range(model.nu)]
    assert names == list(driven.names) == [each.name for each in MIXED.actuators]
    assert [model.tendon(i).name for i in range(model.ntendon)] == names
    assert model.nv == len(driven.chain) == model.neq + 6  # a stage, two bends, two bends and a length
    np.testing.assert_allclose(
        model.actuator_ctrlrange, [each.limits for each in MIXED.actuators if each.limits[0] > -1e9]
    )
    np.testing.assert_allclose(model.body_subtreemass[0], 1.0)
    assert model.opt.gravity.tolist() == [0, 0, 0]
    q = np.stack([shape(MIXED, seed) for seed in range(3)])
    np.testing.assert_allclose(driven.controls(q), MIXED.to_actuators(q))


def test_what_no_actuator_determines_has_a_drive_of_its_own(tmp_path: Path) -> None:
    plain = ROBOTS["without motors"].to_mjcf(tmp_path / "plain.xml")
    assert plain.names == tuple(f"s{k}.{each}" for k in (1, 2) for each in ("bend_x", "bend_y", "length"))
    one = ROBOTS["of one segment"].to_mjcf(tmp_path / "one.xml")
    assert one.names == ("s1.t1", "s1.t2")  # they drive one plane, and there is no joint across it
    assert repr(one) == "DrivenChain(2 drives, 8 joints)"
    stretching = sn.Robot([sn.Segment((40.0, 50.0), 2.0, tendons=sn.Tendons(3, radius=3))])
    assert stretching.to_mjcf(tmp_path / "long.xml").names == ("s1.t1", "s1.t2", "s1.t3", "s1.length")


def test_a_segment_that_is_pushed_stays_an_arc(tmp_path: Path) -> None:
    """Equalities hold the joints of a bend together, whatever pushes at one of them."""
    driven = ROBOTS["of tendons"].to_mjcf(tmp_path / "arm.xml", 4)
    model, data = simulated(tmp_path / "arm.xml")
    body = model.body("s2_2_x").id
    for _ in range(500):
        data.xfrc_applied[body, 0] = 1e5
        mujoco.mj_step(model, data)
    joints = joints_of(driven, data)
    moved = driven.chain.matrix.T @ joints / (driven.chain.matrix**2).sum(axis=0).clip(1e-9)
    assert np.abs(moved).max() > 0.02
    assert np.abs(joints - driven.chain.matrix @ moved).max() < 0.05 * np.abs(joints).max()


def test_links_touch_obstacles_and_not_each_other(tmp_path: Path) -> None:
    robot = ROBOTS["of tendons"]
    driven = robot.to_mjcf(tmp_path / "arm.xml", 4)
    file = tmp_path / "arm.xml"
    ball = '<worldbody><geom name="ball" type="sphere" pos="60 0 150" size="30"/></worldbody></mujoco>'
    file.write_text(file.read_text(encoding="utf-8").replace("</mujoco>", ball), encoding="utf-8")
    model, data = simulated(file)
    assert data.ncon == 0
    q = np.array([[0.3, 0, 50.0]] * 4)
    data.ctrl[:] = driven.controls(q)
    mujoco.mj_step(model, data, nstep=1500)
    assert data.ncon > 0
    away = np.linalg.norm(np.delete(data.geom_xpos, model.geom("ball").id, axis=0) - [60, 0, 150], axis=1)
    assert away.min() > 30.0 + 4.0 - 2.0


def test_bad_arguments_are_refused(tmp_path: Path) -> None:
    refused("mass", lambda: MIXED.to_mjcf(tmp_path / "arm.xml", mass=0), "greater than 0")
    refused("joints_per_segment", lambda: MIXED.to_mjcf(tmp_path / "arm.xml", 0))
    refused("robot", lambda: sn.Robot([sn.Segment(50, 0)]).to_mjcf(tmp_path / "arm.xml"), "bends or stretches")
    refused("file", lambda: MIXED.to_mjcf(tmp_path / "nowhere" / "arm.xml"), "can be written")


def test_points_have_times_from_the_first_on(tmp_path: Path) -> None:
    positions = np.array([[0.0, 1.0], [0.5, 2.0], [1.0, 3.0]])
    times = np.array([2.0, 2.25, 4.9999999999])
    message = joint_trajectory(["a", "b"], times, positions)
    assert message["joint_names"] == ["a", "b"]
    assert [point["positions"] for point in message["points"]] == positions.tolist()
    assert [point["time_from_start"] for point in message["points"]] == [
        {"sec": 0, "nanosec": 0},
        {"sec": 0, "nanosec": 250_000_000},
        {"sec": 3, "nanosec": 0},
    ]
    assert "velocities" not in message["points"][0]
    write_json(tmp_path / "out.json", message)
    assert json.loads((tmp_path / "out.json").read_text()) == message
