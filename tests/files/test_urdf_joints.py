"""Joints read from a URDF, held against MuJoCo and against the shapes that capsules must contain."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.files import link_capsules
from sinuous.model.joints import Fixed, LinkCapsule
from tests.helpers import Floats, refused, with_each

SIX = """<robot name="six">
<link name="world"/>
<link name="base"><collision><geometry><cylinder radius="0.1" length="0.3"/></geometry></collision></link>
<joint name="stand" type="fixed"><parent link="world"/><child link="base"/><origin xyz="1 0 0" rpy="0 0 1.5"/></joint>
<link name="a"><visual><geometry><cone/></geometry></visual>
 <collision><origin xyz="0 0 .2" rpy="0.1 0 0"/><geometry><box size="0.1 0.12 0.4"/></geometry></collision></link>
<joint name="j1" type="continuous"><parent link="base"/><child link="a"/><origin xyz="0 0 .2"/>
 <axis xyz="0 0 1"/></joint>
<link name="b"><collision><geometry><sphere radius="0.08"/></geometry></collision>
 <collision><origin xyz="0.2 0 0" rpy="0 1.57 0"/><geometry><capsule radius="0.05" length="0.3"/></geometry></collision>
</link>
<joint name="j2" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 .4" rpy="0.1 0.2 0.3"/>
 <axis xyz="0 2 0"/><limit lower="-2" upper="1" effort="1" velocity="3"/></joint>
<link name="side"><collision><geometry><sphere radius="0.03"/></geometry></collision></link>
<joint name="hold" type="fixed"><parent link="b"/><child link="side"/><origin xyz="0 0.2 0"/></joint>
<link name="wrist"/>
<joint name="on" type="fixed"><parent link="b"/><child link="wrist"/><origin xyz="0.4 0 0" rpy="0 0 1"/></joint>
<link name="c"/>
<joint name="j3" type="prismatic"><parent link="wrist"/><child link="c"/><origin xyz="0 0 .1" rpy="0 0 .3"/>
 <axis xyz="1 0 0"/><limit lower="-.1" upper=".5" effort="1" velocity="0"/></joint>
<link name="finger"/>
<joint name="close" type="prismatic"><parent link="c"/><child link="finger"/>
 <limit lower="0" upper=".5" effort="1" velocity="0"/><mimic joint="j3"/></joint>
<link name="tool0"><collision><geometry><mesh filename="package://six/meshes/tool.stl" scale="0.1 0.1 0.1"/></geometry>
 </collision></link>
<joint name="t" type="fixed"><parent link="c"/><child link="tool0"/><origin xyz="0 0 .1" rpy="0 0.7 0"/></joint>
</robot>"""


@pytest.fixture
def six(tmp_path: Path) -> Path:
    (tmp_path / "meshes").mkdir()
    trimesh.creation.annulus(0.2, 0.5, 2.0).export(tmp_path / "meshes" / "tool.stl")
    (tmp_path / "six.urdf").write_text(SIX)
    return tmp_path / "six.urdf"


def changed(file: Path, old: str, new: str) -> Path:
    assert old in SIX
    other = file.with_name("other.urdf")
    other.write_text(SIX.replace(old, new, 1))
    return other


def within(capsules: Any, points: Floats) -> Any:
    """Which points (m, 3) are in one of these capsules."""
    found = np.zeros(len(points), np.bool_)
    for start, end, radius in capsules:
        along = end - start
        share = np.clip((points - start) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
        found |= np.linalg.norm(points - start - share[:, None] * along, axis=1) <= radius
    return found


def test_the_chain_moves_as_in_mujoco(six: Path) -> None:
    joints = sn.read_joints(six, "tool0")
    assert [joint.name for joint in joints] == ["world", "j1", "j2", "j3", "tool0"]
    robot = sn.Robot(joints=joints)
    assert robot.joint_names == ("j1", "j2", "j3")
    text = SIX.replace("<cone/>", '<sphere radius="1"/>').replace("capsule", "cylinder")
    text = text.replace(
        '<robot name="six">',
        '<robot name="six"><mujoco><compiler fusestatic="false" boundmass="1" boundinertia="1"/></mujoco>',
    )
    model = mujoco.MjModel.from_xml_string(
        text.replace("package://six/meshes/", ""), {"tool.stl": (six.parent / "meshes" / "tool.stl").read_bytes()}
    )
    data = mujoco.MjData(model)
    rng = np.random.default_rng(0)
    for _ in range(3):
        values = rng.uniform((-3, -2, -0.1), (3, 1, 0.5))
        for name, value in zip(robot.joint_names, values.tolist(), strict=True):
            data.joint(name).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        pose = robot.tip(None, values)
        np.testing.assert_allclose(pose[:3, 3], data.body("tool0").xpos, atol=1e-12)
        np.testing.assert_allclose(pose[:3, :3], data.body("tool0").xmat.reshape(3, 3), atol=1e-12)


def test_limits_rates_and_notes_are_those_of_the_file(six: Path) -> None:
    base, j1, j2, j3, tip = sn.read_joints(six, "tool0")
    assert (j2.limits, j2.rate, j3.limits, j3.rate) == ((-2, 1), 3, (-0.1, 0.5), np.inf)
    assert j1.limits == (-np.pi, np.pi)
    assert j1.notes[0] == "turns without end in the file, and from -pi to pi here"
    assert j2.notes == ("link 'b': 2 capsules", "link 'side': 1 capsule")
    assert "its velocity of 0 is taken for none" in j3.notes
    assert any("'finger'" in note and "'close'" in note for note in j3.notes)
    assert (tip.body, base.origin.tolist()) == ((), np.eye(4).tolist())
    robot = sn.Robot([sn.Segment(1.0)], joints=[base, j1, j2, j3, tip])
    assert "j1: turns without end in the file, and from -pi to pi here" in robot.notes
    assert not sn.Robot(joints=sn.read_joints(six, "tool0", meshes=False)).joints[3].body
    short = sn.read_joints(six, "b", "a")
    assert [(joint.name, len(joint.body)) for joint in short] == [("a", 1), ("j2", 2)]  # what hangs on the tip is none


def test_capsules_contain_the_shapes_of_links(six: Path) -> None:
    _, j1, j2, j3, _ = sn.read_joints(six, "tool0")
    rng = np.random.default_rng(0)
    box = rng.uniform(-0.5, 0.5, (2000, 3)) * (0.1, 0.12, 0.4) @ Rotation.from_euler("x", 0.1).as_matrix().T + (
        0,
        0,
        0.2,
    )
    assert within(j1.body, box).all()
    assert j2.body[2].start.tolist() == [0.0, 0.2, 0.0]
    tool = trimesh.load_mesh(six.parent / "meshes" / "tool.stl").sample(3000) * 0.1
    placed = tool @ Rotation.from_euler("y", 0.7).as_matrix().T + (0, 0, 0.1)
    assert within(j3.body, placed).all()
    scaled = sn.read_joints(six, "tool0", scale=1000)
    np.testing.assert_allclose(scaled[2].body[0].radius, 80.0)
    pose = sn.Robot(joints=scaled).tip(None, [0.3, -0.4, 200.0])
    own = sn.Robot(joints=[sn.read_joints(six, "tool0")[0], j1, j2, j3, sn.read_joints(six, "tool0")[-1]])
    np.testing.assert_allclose(pose[:3, 3], 1000 * own.tip(None, [0.3, -0.4, 0.2])[:3, 3])
    slow = changed(six, 'upper=".5" effort="1" velocity="0"', 'upper=".5" effort="1" velocity="0.02"')
    _, _, turning, sliding, _ = sn.read_joints(slow, "tool0", scale=1000)
    assert (turning.limits, turning.rate, sliding.limits, sliding.rate) == ((-2, 1), 3, (-100, 500), 20)


@with_each("size", [(1, 1, 1), (1, 1, 8), (4, 4, 1), (10, 1, 0.1), (1, 0, 3), (2, 0, 0), (0, 0, 0)])
def test_a_capsule_of_a_box_is_not_much_larger(size: tuple[float, float, float]) -> None:
    shape = link_capsules.box_shape(np.eye(4), np.array(size, np.float64))
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (3000, 3)) * size
    assert within(shape.capsules, points).all()
    longest, wide = max(size), float(np.linalg.norm(sorted(size)[:2]))
    around = link_capsules.volume_of([LinkCapsule(np.zeros(3), np.array([longest, 0.0, 0.0]), 0.5 * wide)])
    ball = link_capsules.volume_of([LinkCapsule(np.zeros(3), np.zeros(3), 0.5 * float(np.linalg.norm(size)))])
    assert link_capsules.volume_of(shape.capsules) <= min(around, ball) * 1.001 + 1e-9


def test_a_bent_shape_gets_several_capsules() -> None:
    upright, across = trimesh.creation.box((1, 1, 6)), trimesh.creation.box((6, 1, 1))
    across.apply_translation((2.5, 0, 3.5))
    elbow = trimesh.boolean.union([upright, across])
    edges = np.asarray(elbow.vertices)[elbow.edges_unique]
    shape = link_capsules.solid_shape(np.asarray(elbow.vertices), float(elbow.volume), edges)
    assert len(shape.capsules) > 1
    assert within(shape.capsules, trimesh.sample.volume_mesh(elbow, 3000)).all()
    alone = link_capsules.solid_shape(np.asarray(elbow.vertices)).capsules
    assert link_capsules.volume_of(shape.capsules) < link_capsules.volume_of(alone)


def test_links_that_may_touch_are_those_of_the_srdf(six: Path) -> None:
    text = '<robot name="six"><disable_collisions link1="c" link2="a" reason="Never"/>{}</robot>'
    pair = '<disable_collisions link1="{}" link2="{}" reason="Never"/>'
    srdf = six.with_name("six.srdf")
    for said, touching in (
        ((("tool0", "a"),), [(), (), (), ("j1",), ()]),
        ((("tool0", "base"), ("side", "base")), [(), (), (), ("world",), ()]),  # b may not, which moves with the side
        ((("b", "base"), ("base", "side")), [(), (), ("world",), (), ()]),
    ):
        srdf.write_text(text.format("".join(pair.format(*each) for each in said)))
        joints = sn.read_joints(six, "tool0", srdf=srdf)
        assert [joint.touches for joint in joints] == touching
        sn.Robot(joints=joints)


@with_each(
    ("old", "new", "said"),
    [
        ('lower="-2" upper="1"', "", "joint j2.limit: missing"),
        ('<limit lower="-2" upper="1" effort="1" velocity="3"/>', "", "joint j2.limit: missing"),
        ('type="continuous"', 'type="floating"', "joint j1.type: expected one of revolute, .*, got 'floating'"),
        ('type="revolute"', 'type="planar"', "joint j2.type"),
        ('lower="-2" upper="1"', 'lower="2" upper="1"', "joint j2.limits: lower limit above"),
        ("0 2 0", "0 0 0", "joint j2.axis"),
        ("tool.stl", "none.stl", "link tool0.mesh: there is no such file; .*meshes=False"),
        ("tool.stl", "six.urdf", "link tool0.mesh: there is no such file"),
        ('<sphere radius="0.08"/>', "<cone/>", "urdf: cannot be read: Unknown tag: cone"),
        ('radius="0.08"', 'radius="-0.08"', r"joint j2.body\[0\].radius"),
        ("</robot>", "", "urdf: no XML"),
        ('<link name="a">', '<link name="a"><xacro:x xmlns:xacro="http://ros.org/wiki/xacro"/>', "urdf: has macros"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_one_line(six: Path, old: str, new: str, said: str) -> None:
    other = changed(six, old, new)
    with pytest.raises(sn.InputError, match=f"^{other}: {said}") as caught:
        sn.read_joints(other, "tool0")
    assert "\n" not in str(caught.value)


@with_each(
    ("arguments", "said"),
    [
        ({}, "six.urdf: tip: missing, and there are 3"),
        ({"tip": "tol0"}, "tip: no link is called so; did you mean 'tool0'?"),
        ({"tip": "finger"}, "joint close.mimic: it moves with 'j3'"),
        ({"tip": "a", "root": "b"}, "tip: no joints lead to it from 'b'"),
        ({"tip": "world"}, "tip: is the root itself"),
        ({"tip": "tool0", "srdf": "no.srdf"}, "srdf: cannot be read"),
        ({"tip": "tool0", "meshes": 1}, "meshes: expected true or false"),
        ({"tip": "tool0", "scale": 0}, "scale: expected a number greater than 0"),
    ],
)
def test_arguments_that_do_not_fit_are_refused(six: Path, arguments: dict[str, Any], said: str) -> None:
    with pytest.raises(sn.InputError) as caught:
        sn.read_joints(six, **arguments)
    assert said in str(caught.value)


def test_a_missing_reader_is_named(six: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "yourdfpy", None)
    words = "needs yourdfpy; expected it installed: pip install sinuous[urdf]"
    refused("urdf", lambda: sn.read_joints(six, "tool0"), words)


def test_a_robot_that_was_read_is_saved_and_loaded(six: Path) -> None:
    joints = sn.read_joints(six, "tool0")
    robot = sn.Robot([sn.Segment(1.0, 2.0)], joints=joints, name="six")
    for name in ("arm.yaml", "arm.json"):
        robot.save(six.with_name(name))
        assert sn.load(six.with_name(name), sn.Robot).equals(robot)
    file = six.with_name("short.yaml")
    file.write_text("segments: {length: 1, max_bend: 2}\nname: six\njoints: {urdf: six.urdf, tip: tool0}\n")
    assert sn.load(file, sn.Robot).equals(robot)
    alone = sn.Robot(joints=joints)
    alone.save(file)
    assert sn.load(file, sn.Robot).equals(alone)
    assert isinstance(alone.joints[-1], Fixed)
