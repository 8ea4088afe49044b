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
from sinuous.base.errors import InputError
from sinuous.files.joint_chain import ChainJoint, JointChain, Link
from sinuous.model.poses import pose

THIN = 0.005
"""Radius, as a share of the robot's mean length, of an arm that has none, to be looked at."""

LINKS = ("world", "base", "tip", "tool")
"""Links of every file."""


def write_urdf(file: str | Path, chain: JointChain) -> None:
    """Write a chain as URDF: links `world`, `base`, one for each joint under its name, `tip` and `tool`.

    Raises
    ------
    InputError
        When a joint has the name of one of these links, or the file cannot be written.
    """
    for name in chain.names:
        if name in LINKS:
            raise InputError("joints", "a URDF has a link of that name already", name, "another name for the joint")
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
    for name, place in (("tip", chain.tip), ("tool", robot.tool)):
        _fixed(root, parent, name, place)
        _link(root, name, Link(), thin)
        parent = name
    return root


def _link(root: Element, name: str, link: Link, thin: float) -> None:
    element = SubElement(root, "link", name=name)
    inertial = SubElement(element, "inertial")
    SubElement(inertial, "mass", value="1")
    moment = text(0.4 * thin * thin)
    SubElement(inertial, "inertia", ixx=moment, iyy=moment, izz=moment, ixy="0", ixz="0", iyz="0")
    for start, end, radius in link.cylinders:
        along, middle = end - start, 0.5 * (start + end)
        length = float(np.linalg.norm(along))
        _shape(element, "cylinder", pose(middle, direction=along), radius, thin, {"length": text(length)})
    for place, radius in link.balls:
        _shape(element, "sphere", pose(place), radius, thin, {})


def _shape(element: Element, kind: str, place: Floats, radius: float, thin: float, size: dict[str, str]) -> None:
    for use in ("visual", "collision") if radius > 0.0 else ("visual",):
        shape = SubElement(element, use)
        _origin(shape, place)
        SubElement(SubElement(shape, "geometry"), kind, {"radius": text(radius or thin), **size})


def _origin(element: Element, place: Floats) -> None:
    turned = {} if np.array_equal(place[:3, :3], np.eye(3)) else {"rpy": texts(roll_pitch_yaw(place[:3, :3]))}
    SubElement(element, "origin", {"xyz": texts(place[:3, 3].tolist())} | turned)


def _joint(root: Element, parent: str, joint: ChainJoint) -> None:
    element = SubElement(root, "joint", name=joint.name, type="prismatic" if joint.slides else "revolute")
    _origin(element, joint.origin)
    _ends(element, parent, joint.name)
    SubElement(element, "axis", xyz=texts(joint.axis))
    low, high = map(text, joint.limits)
    fast = text(joint.rate) if joint.rate < math.inf else "1"
    SubElement(element, "limit", lower=low, upper=high, effort="1", velocity=fast)


def _fixed(root: Element, parent: str, child: str, place: Floats) -> None:
    element = SubElement(root, "joint", name=f"{child}_joint", type="fixed")
    _origin(element, place)
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
