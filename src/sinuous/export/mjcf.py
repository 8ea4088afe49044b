"""A robot with its motors as MJCF, the model format of MuJoCo: the file that moves it as the motors do.

Joints are those of `JointChain`. Equalities keep the joints of one bend or length in step, so that a segment stays an
arc. A *fixed* tendon, in MuJoCo, is a weighed sum of joint values: the displacement of an actuator, exactly. A servo
pulls at it until it is what the control says, in the unit of the motor.

Masses are nominal, there is no gravity, and links do not touch each other; they touch what else is in the model.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from sinuous.checks import Floats
from sinuous.export.chain import Joint, Link
from sinuous.export.drives import STEP, Drive, DrivenChain, couplings
from sinuous.export.urdf import THIN, TURNING, text, texts
from sinuous.writing.documents import write_xml

STIFF = "0.005 1"
"""Time (s) in which an equality is restored, and its damping ratio."""

BEYOND = 1.001
"""Joints stop this much beyond their limits: there, a limit would pull at what is at it."""


def write_mjcf(file: str | Path, driven: DrivenChain) -> None:
    """Write a driven chain as MJCF: body `base`, a body each time joints come, sites `tip` and `tool`.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    write_xml(file, model_element(driven))


def model_element(driven: DrivenChain) -> Element:
    """Return the model as an element of XML."""
    robot = driven.chain.robot
    root = Element("mujoco", model=robot.name or "robot")
    SubElement(root, "compiler", angle="radian", autolimits="true")
    SubElement(root, "option", gravity="0 0 0", timestep=text(STEP), integrator="implicitfast")
    own = SubElement(SubElement(root, "default"), "default", {"class": "arm"})
    SubElement(own, "geom", contype="1", conaffinity="0", rgba="0.85 0.55 0.3 1")
    _bodies(SubElement(root, "worldbody"), driven)
    _tendons(SubElement(root, "tendon"), driven.drives)
    _servos(SubElement(root, "actuator"), driven.drives)
    equality = SubElement(root, "equality")
    for joint, leader, ratio in couplings(driven.chain):
        SubElement(equality, "joint", joint1=joint, joint2=leader, polycoef=f"0 {text(ratio)} 0 0 0", solref=STIFF)
    rest = texts(driven.controls([(0.0, 0.0, 0.5 * sum(segment.length)) for segment in robot.segments]))
    at_rest = texts(_middle(joint) for joint in driven.chain.joints)
    SubElement(SubElement(root, "keyframe"), "key", name="rest", qpos=at_rest, ctrl=rest)
    return root


def _bodies(world: Element, driven: DrivenChain) -> None:
    chain = driven.chain
    robot = chain.robot
    density = driven.mass / sum(segment.length[1] for segment in robot.segments)
    body = SubElement(world, "body", {"name": "base", "childclass": "arm"} | _pose(robot.base))
    thin = THIN * robot.mean_length
    _shapes(body, chain.first, density, thin)
    numbers = {joint.name: i for i, joint in enumerate(chain.joints)}
    for joints in _together(chain.joints):
        height = joints[0].height + sum(_middle(joint) for joint in joints)
        body = SubElement(body, "body", name=joints[-1].name, pos=f"0 0 {text(height)}")
        for joint in joints:
            i = numbers[joint.name]
            inertia = {"armature": text(driven.armature[i]), "damping": text(driven.damping[i])}
            SubElement(body, "joint", {"name": joint.name} | _joint(joint) | inertia)
        _shapes(body, joints[-1].link, density, thin)
    SubElement(body, "site", name="tip", pos=f"0 0 {text(chain.end)}", size=text(thin))
    at_tip = robot.tool.copy()
    at_tip[2, 3] += chain.end
    SubElement(body, "site", {"name": "tool", "size": text(thin)} | _pose(at_tip))


def _together(joints: tuple[Joint, ...]) -> Iterator[list[Joint]]:
    """Yield runs of joints with nothing between them: they move one body."""
    run: list[Joint] = []
    for joint in joints:
        run.append(joint)
        if joint.link.cylinders or joint.link.balls:
            yield run
            run = []
    if run:
        yield run


def _middle(joint: Joint) -> float:
    """Where a joint stands in the file: turns are straight, stretches half way."""
    return 0.5 * (joint.limits[0] + joint.limits[1])


def _joint(joint: Joint) -> dict[str, str]:
    """What is said of a joint, as in MuJoCo."""
    middle = _middle(joint)
    low, high = (middle + BEYOND * (end - middle) for end in joint.limits)
    kind = {"type": "slide", "ref": text(middle)} if joint.axis == "z" else {"type": "hinge"}
    return kind | {"axis": TURNING[joint.axis], "range": texts((low, high))}


def _shapes(body: Element, link: Link, density: float, thin: float) -> None:
    """Add the shapes of a link; cylinders carry the mass, by their lengths."""
    for low, high, radius in link.cylinders:
        size = f"{text(radius or thin)} {text(0.5 * (high - low))}"
        _shape(body, "cylinder", 0.5 * (low + high), size, density * (high - low), radius)
    for height, radius in link.balls:
        _shape(body, "sphere", height, text(radius or thin), 0.0, radius)


def _shape(body: Element, kind: str, height: float, size: str, mass: float, radius: float) -> None:
    shape = {"type": kind, "pos": f"0 0 {text(height)}", "size": size, "mass": text(mass)}
    SubElement(body, "geom", shape if radius > 0.0 else shape | {"contype": "0"})


def _tendons(element: Element, drives: tuple[Drive, ...]) -> None:
    for drive in drives:
        tendon = SubElement(element, "fixed", name=drive.name)
        for joint, weight in drive.joints.items():
            SubElement(tendon, "joint", joint=joint, coef=text(weight))


def _servos(element: Element, drives: tuple[Drive, ...]) -> None:
    """Add servos: force = stiffness (control - value) - damping speed, value = gear x length of the tendon + zero."""
    for drive in drives:
        zero = drive.gain * drive.constant + drive.offset
        bias = -drive.stiffness * zero, -drive.stiffness, -drive.damping
        servo = {"gear": text(drive.gain), "gaintype": "fixed", "gainprm": text(drive.stiffness)}
        servo |= {"biastype": "affine", "biasprm": texts(bias)}
        if -math.inf < drive.limits[0] < drive.limits[1] < math.inf:
            servo["ctrlrange"] = texts(drive.limits)
        SubElement(element, "general", {"name": drive.name, "tendon": drive.name} | servo)


def _pose(pose: Floats) -> dict[str, str]:
    axes = [*pose[:3, 0].tolist(), *pose[:3, 1].tolist()]
    return {"pos": texts(pose[:3, 3].tolist()), "xyaxes": texts(axes)}
