"""A chain of joints as URDF, the robot description of ROS, which RViz, MuJoCo and PyBullet load.

Shapes are cylinders and balls of the radius of the body. Masses are nominal, one unit a link: the file is meant for
kinematics, pictures and collision checks, not for dynamics. An arm without a radius has shapes to look at, and none
that collide.
"""

import math
from collections.abc import Iterable
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.documents import write_xml
from sinuous.files.joint_chain import ChainJoint, JointChain, Link

THIN = 0.005
"""Radius, as a share of the robot's mean length, of an arm that has none, to be looked at."""

TURNING = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}


def write_urdf(file: str | Path, chain: JointChain) -> None:
    """Write a chain as URDF: links `world`, `base`, one for each joint under its name, `tip` and `tool`.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    write_xml(file, robot_element(chain))


def robot_element(chain: JointChain) -> Element:
    """Return the chain as an element of XML."""
    robot = chain.robot
    root = Element("robot", name=robot.name or "robot")
    compiler = SubElement(SubElement(root, "mujoco"), "compiler")  # an extension of URDF that other readers pass over
    compiler.attrib.update(fusestatic="false", discardvisual="false", strippath="false")
    thin = THIN * robot.mean_length
    SubElement(root, "link", name="world")
    _fixed(root, "world", "base", robot.base)
    _link(root, "base", chain.first, thin)
    parent = "base"
    for joint in chain.joints:
        _joint(root, parent, joint)
        _link(root, joint.name, joint.link, thin)
        parent = joint.name
    at_tip = np.eye(4)
    at_tip[2, 3] = chain.end
    for name, pose in (("tip", at_tip), ("tool", robot.tool)):
        _fixed(root, parent, name, pose)
        _link(root, name, Link(), thin)
        parent = name
    return root


def _link(root: Element, name: str, link: Link, thin: float) -> None:
    element = SubElement(root, "link", name=name)
    inertial = SubElement(element, "inertial")
    SubElement(inertial, "mass", value="1")
    moment = text(0.4 * thin * thin)
    SubElement(inertial, "inertia", ixx=moment, iyy=moment, izz=moment, ixy="0", ixz="0", iyz="0")
    for low, high, radius in link.cylinders:
        size = {"length": text(high - low)}
        _shape(element, "cylinder", 0.5 * (low + high), radius, thin, size)
    for height, radius in link.balls:
        _shape(element, "sphere", height, radius, thin, {})


def _shape(element: Element, kind: str, height: float, radius: float, thin: float, size: dict[str, str]) -> None:
    for use in ("visual", "collision") if radius > 0.0 else ("visual",):
        shape = SubElement(element, use)
        SubElement(shape, "origin", xyz=f"0 0 {text(height)}")
        SubElement(SubElement(shape, "geometry"), kind, {"radius": text(radius or thin), **size})


def _joint(root: Element, parent: str, joint: ChainJoint) -> None:
    kind = "prismatic" if joint.axis == "z" else "revolute"
    element = SubElement(root, "joint", name=joint.name, type=kind)
    SubElement(element, "origin", xyz=f"0 0 {text(joint.height)}")
    _ends(element, parent, joint.name)
    SubElement(element, "axis", xyz=TURNING[joint.axis])
    low, high = map(text, joint.limits)
    SubElement(element, "limit", lower=low, upper=high, effort="1", velocity="1")


def _fixed(root: Element, parent: str, child: str, pose: Floats) -> None:
    element = SubElement(root, "joint", name=f"{child}_joint", type="fixed")
    xyz, rpy = pose[:3, 3].tolist(), roll_pitch_yaw(pose[:3, :3])
    SubElement(element, "origin", xyz=texts(xyz), rpy=texts(rpy))
    _ends(element, parent, child)


def _ends(element: Element, parent: str, child: str) -> None:
    SubElement(element, "parent", link=parent)
    SubElement(element, "child", link=child)


def text(value: float) -> str:
    """A number to the last digit."""
    return repr(float(value))


def texts(values: Iterable[float]) -> str:
    """Numbers with spaces between them."""
    return " ".join(map(text, values))


def roll_pitch_yaw(rotation: Floats) -> tuple[float, float, float]:
    """Angles about the fixed axes x, y and z, in this order, that make a matrix (3, 3); yaw is 0 where two agree."""
    level = math.hypot(rotation[0, 0], rotation[1, 0])
    pitch = math.atan2(-rotation[2, 0], level)
    if level < 1e-12:
        return math.atan2(-rotation[1, 2], rotation[1, 1]), pitch, 0.0
    return math.atan2(rotation[2, 1], rotation[2, 2]), pitch, math.atan2(rotation[1, 0], rotation[0, 0])
