"""A robot with its motors as MJCF, the model format of MuJoCo: the file that moves it as the motors do.

Joints are those of `JointChain`. Equalities keep the joints of one bend or length in step, so that a segment stays an
arc. A *fixed* tendon, in MuJoCo, is a weighed sum of joint values: the displacement of an actuator, exactly. A servo
pulls at it until it is what the control says, in the unit of the motor.

A servo pushes with `stiffness x (wish - displacement)`. In coordinates of the robot, scaled so that the inertia is 1,
all servos together are a matrix of stiffness; it is as large as the time step allows, and damped by a share of the
inertia and one of the stiffness (Rayleigh), so that every mode is damped critically or more.

Masses are nominal, there is no gravity, and links do not touch each other; they touch what else is in the model.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import NDArray

from sinuous.base.arguments import JointsAndBatch
from sinuous.base.checks import Floats
from sinuous.base.documents import write_xml
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, call
from sinuous.files.joint_chain import THIN, ChainJoint, JointChain, Link, note_limits, text, texts
from sinuous.kernels.packing import BendLine
from sinuous.model.poses import pose
from sinuous.model.segment import coordinate_names

if TYPE_CHECKING:
    from sinuous.model.robot import Robot


STEP = 0.002
"""Time step of the simulation, s."""

STIFFEST = 0.2
"""Phase in rad by which the stiffest mode turns in one step of a simulation; from 2 on the integration explodes."""

LIGHT = 1e-3
"""Mass of a link without a body, as a share of that of the arm."""

SLOWEST = 1e-6
"""Modes whose stiffness is less than this share of the largest are driven by nothing."""


class Drive(NamedTuple):
    """A servo on a linear combination of joints.

    Attributes
    ----------
    name : str
        Of the actuator, or of the coordinate that it moves.
    joints : dict
        Weights of the joints that it pulls at, by their names; the sum of their values, so weighed, and `constant` are
        the displacement.
    constant : float
    gain, offset : float
        The value that it is told is gain x displacement + offset.
    limits : (float, float)
        Least and largest of these values.
    stiffness, damping : float
        Force for each unit of the value, and for each unit of its speed.
    """

    name: str
    joints: dict[str, float]
    constant: float
    gain: float
    offset: float
    limits: tuple[float, float]
    stiffness: float
    damping: float


class DrivenChain(Frozen):
    """A chain of joints with drives: of every actuator of the robot, and of every coordinate that none determines.

    Parameters
    ----------
    robot : Robot
    chain : JointChain
    undetermined : ndarray of bool (n, 3)
        Coordinates that can move and that no actuator determines.
    mass : float
        Of the whole arm, spread evenly over its greatest length.

    Attributes
    ----------
    drives : tuple of Drive
        Without actuators that can move nothing.
    armature, damping : ndarray (j,)
        Inertia and damping of every joint, beside that of what hangs on it.
    """

    chain: JointChain
    mass: float
    drives: tuple[Drive, ...]
    armature: Floats
    damping: Floats
    _rows: Floats
    _offsets: Floats

    def __init__(self, robot: "Robot", chain: JointChain, undetermined: NDArray[np.bool_], mass: float) -> None:
        columns = np.flatnonzero(chain.matrix.any(axis=0))
        if not len(columns):
            raise InputError("robot", "nothing of it can move", robot, "a segment that bends or stretches")
        open_ones = np.flatnonzero(undetermined.ravel())
        rows = np.concatenate([robot.drive.jacobian, np.eye(3 * len(robot))[open_ones]])
        own_joints = {(joint.segment, joint.coordinate): joint for joint in chain.joints[: len(robot.joint_names)]}
        alone = [own_joints.get(divmod(int(c), 3)) for c in open_ones]
        moving = np.flatnonzero(rows[:, columns].any(axis=1))
        own, wanted = robot.drive.motors, len(open_ones)
        gain, offset = (
            np.append(own.gain, np.ones(wanted)),
            np.append(own.offset, [0.0 if j is None else j.offset for j in alone]),
        )
        own_names = coordinate_names(robot.row_names)
        names = [a.name for a in robot.actuators]
        names += [own_names[c] if j is None else j.name for c, j in zip(open_ones, alone, strict=True)]
        limits = [a.limits for a in robot.actuators]
        limits += [_limits(robot, int(c)) if j is None else j.limits for c, j in zip(open_ones, alone, strict=True)]
        inertia = np.tile([robot.mean_length**2] * 2 + [1.0], len(robot)) * mass
        squares = (chain.matrix**2).sum(axis=0)
        stiffness, of_stiffness, of_inertia = _servos(rows[np.ix_(moving, columns)], inertia[columns])
        still = np.delete(np.arange(3 * len(robot)), columns)
        fixed = robot.drive.coordinates.origin.ravel()[still]
        drives = []
        for i, own_stiffness in zip(moving.tolist(), stiffness.tolist(), strict=True):
            weights = chain.matrix[:, columns] @ (rows[i, columns] / squares[columns])
            joints = {chain.names[j]: float(weights[j]) for j in np.flatnonzero(weights)}
            turned = own_stiffness / gain[i] ** 2
            constant = float(rows[i, still] @ fixed) - float(weights @ chain.offsets)
            told = float(gain[i]), float(offset[i])
            drives.append(Drive(names[i], joints, constant, *told, limits[i], turned, of_stiffness * turned))
        armature = (chain.matrix != 0.0) @ np.divide(inertia, squares, out=np.zeros(len(squares)), where=squares > 0.0)
        self._set(chain=chain, mass=mass, drives=tuple(drives), armature=armature)
        self._set(damping=of_inertia * armature, _rows=(gain[:, None] * rows)[moving], _offsets=offset[moving])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all drives, in the order of their controls."""
        return tuple(drive.name for drive in self.drives)

    def controls(self, q: JointsAndBatch) -> Floats:
        """What drives are told (..., d) so that the robot takes configurations (..., n, 3)."""
        checked = self.chain.robot.configuration("q", q)
        return checked.reshape(*checked.shape[:-2], -1) @ self._rows.T + self._offsets

    def __len__(self) -> int:
        return len(self.drives)

    def __repr__(self) -> str:
        return call("DrivenChain", [f"{len(self)} drives", f"{len(self.chain)} joints"])


def _servos(rows: Floats, inertia: Floats) -> tuple[Floats, float, float]:
    """Stiffness of servos on displacements `rows` (d, c) of coordinates with such inertia (c,); shares of damping.

    Returns the stiffness (d,), and which multiples of stiffness and of inertia the damping is.
    """
    scaled = rows / np.sqrt(inertia)
    stiffness = 1.0 / (scaled**2).sum(axis=1)
    modes = np.linalg.svd(np.sqrt(stiffness)[:, None] * scaled, compute_uv=False)
    fastest = STIFFEST / STEP
    slowest = fastest * float(modes[modes > np.sqrt(SLOWEST) * modes[0]][-1] / modes[0])
    return stiffness * (fastest / modes[0]) ** 2, 2.0 / fastest, 2.0 * slowest


def _limits(robot: "Robot", column: int) -> tuple[float, float]:
    """Least and largest value of a coordinate."""
    segment, kind = divmod(column, 3)
    low, high = robot.drive.coordinates.lengths[segment].tolist()
    most = min(robot.largest_bends[segment], robot.curvatures[segment] * high)
    return (low, high) if kind == 2 else (-most, most)


def couplings(chain: JointChain) -> list[tuple[str, str, float]]:
    """Joints that move together: a joint, the first one of its coordinate, and how many times as far it moves."""
    first: dict[tuple[int, int], int] = {}
    found: list[tuple[str, str, float]] = []
    for i, joint in enumerate(chain.joints):
        leader = chain.joints[first.setdefault((joint.segment, joint.coordinate), i)]
        if leader is not joint:
            found.append((joint.name, leader.name, joint.weight / leader.weight))
    return found


def _held(chain: JointChain) -> Iterator[tuple[dict[str, str], str]]:
    """Yield equalities of bends in one plane, or locked: joints, and the polynomial that the first one is."""
    first = {(joint.segment, joint.coordinate): joint for joint in reversed(chain.joints)}
    for k, line in enumerate(chain.robot.drive.coordinates.bends):
        if not isinstance(line, BendLine):
            continue
        pair = first.get((k, 0)), first.get((k, 1))
        if line.low == line.high:
            for joint, value in zip(pair, line.at(line.low), strict=True):
                if joint is not None:
                    yield {"joint1": joint.name}, f"{text(joint.weight * value)} 0 0 0 0"
        elif pair[0] is not None and pair[1] is not None and line.plane[0] != 0.0:
            slope = line.plane[1] / line.plane[0]
            constant = pair[1].weight * (line.rest[1] - slope * line.rest[0])
            ratio = slope * pair[1].weight / pair[0].weight
            yield {"joint1": pair[1].name, "joint2": pair[0].name}, f"{text(constant)} {text(ratio)} 0 0 0"


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
    note_limits(root, robot, {"length", "actuator"})
    own = SubElement(SubElement(root, "default"), "default", {"class": "arm"})
    SubElement(own, "geom", contype="1", conaffinity="0", rgba="0.85 0.55 0.3 1")
    _bodies(SubElement(root, "worldbody"), driven)
    _tendons(SubElement(root, "tendon"), driven.drives)
    _add_servos(SubElement(root, "actuator"), driven.drives)
    equality = SubElement(root, "equality")
    for joint, leader, ratio in couplings(driven.chain):
        SubElement(equality, "joint", joint1=joint, joint2=leader, polycoef=f"0 {text(ratio)} 0 0 0", solref=STIFF)
    for held, constant in _held(driven.chain):
        SubElement(equality, "joint", held, polycoef=constant, solref=STIFF)
    middle = [(0.0, 0.0, 0.5 * sum(segment.length)) for segment in robot.rows]
    still = robot.drive.coordinates.project(np.array(middle))
    rest = texts(driven.controls(still))
    free = robot.drive.coordinates.free
    at_rest = texts((_middle(joint) for joint in driven.chain.joints) if free else driven.chain.values(still).tolist())
    SubElement(SubElement(root, "keyframe"), "key", name="rest", qpos=at_rest, ctrl=rest)
    return root


def _bodies(world: Element, driven: DrivenChain) -> None:
    chain = driven.chain
    robot = chain.robot
    links = [chain.first, *(joint.link for joint in chain.joints)]
    density = driven.mass / (sum(float(np.linalg.norm(c.end - c.start)) for own in links for c in own.cylinders) or 1.0)
    body = SubElement(world, "body", {"name": "base", "childclass": "arm"} | _pose(robot.base))
    thin = THIN * robot.mean_length
    _shapes(body, chain.first, density, thin)
    numbers = {joint.name: i for i, joint in enumerate(chain.joints)}
    for joints in _together(chain.joints):
        place = joints[0].origin
        for joint in joints:
            if joint.slides:
                place = place @ pose(_middle(joint) * np.array(joint.axis))
        body = SubElement(body, "body", {"name": joints[-1].name} | _pose(place))
        for joint in joints:
            i = numbers[joint.name]
            inertia = {"armature": text(driven.armature[i]), "damping": text(driven.damping[i])}
            SubElement(body, "joint", {"name": joint.name} | _joint(joint) | inertia)
        _shapes(body, joints[-1].link, density, thin)
        if not joints[-1].link.cylinders:  # what moves has a mass
            mass = {"mass": text(LIGHT * driven.mass), "diaginertia": texts([LIGHT * driven.mass * thin * thin] * 3)}
            SubElement(body, "inertial", {"pos": "0 0 0"} | mass)
    SubElement(body, "site", {"name": "tip", "size": text(thin)} | _pose(chain.tip))
    SubElement(body, "site", {"name": "tool", "size": text(thin)} | _pose(chain.tip @ robot.tool))


def _together(joints: tuple[ChainJoint, ...]) -> Iterator[list[ChainJoint]]:
    """Yield runs of joints with nothing between them: they move one body."""
    run: list[ChainJoint] = []
    for joint in joints:
        if run and (joint.slides or not np.array_equal(joint.origin, np.eye(4))):
            yield run
            run = []
        run.append(joint)
        if joint.link.cylinders or joint.link.balls:
            yield run
            run = []
    if run:
        yield run


def _middle(joint: ChainJoint) -> float:
    """Where a joint stands in the file: turns are straight, stretches half way."""
    return 0.5 * (joint.limits[0] + joint.limits[1])


def _joint(joint: ChainJoint) -> dict[str, str]:
    """What is said of a joint, as in MuJoCo."""
    middle = _middle(joint)
    low, high = (middle + BEYOND * (end - middle) for end in joint.limits)
    kind = {"type": "slide", "ref": text(middle)} if joint.slides else {"type": "hinge"}
    limited = {"range": texts((low, high))} if low < high else {}  # what is locked has an equality
    return kind | {"axis": texts(joint.axis), **limited}


def _shapes(body: Element, link: Link, density: float, thin: float) -> None:
    """Add the shapes of a link; cylinders carry the mass, by their lengths."""
    for start, end, radius in link.cylinders:
        along = end - start
        length = float(np.linalg.norm(along))
        place = pose(0.5 * (start + end), direction=along)
        _shape(body, "cylinder", place, f"{text(radius or thin)} {text(0.5 * length)}", density * length, radius)
    for at, radius in link.balls:
        _shape(body, "sphere", pose(at), text(radius or thin), 0.0, radius)


def _shape(body: Element, kind: str, place: Floats, size: str, mass: float, radius: float) -> None:
    shape = {"type": kind, **_pose(place), "size": size, "mass": text(mass)}
    SubElement(body, "geom", shape if radius > 0.0 else shape | {"contype": "0"})


def _tendons(element: Element, drives: tuple[Drive, ...]) -> None:
    for drive in drives:
        tendon = SubElement(element, "fixed", name=drive.name)
        for joint, weight in drive.joints.items():
            SubElement(tendon, "joint", joint=joint, coef=text(weight))


def _add_servos(element: Element, drives: tuple[Drive, ...]) -> None:
    """Add servos: force = stiffness (control - value) - damping speed, value = gear x length of the tendon + zero."""
    for drive in drives:
        zero = drive.gain * drive.constant + drive.offset
        bias = -drive.stiffness * zero, -drive.stiffness, -drive.damping
        servo = {"gear": text(drive.gain), "gaintype": "fixed", "gainprm": text(drive.stiffness)}
        servo |= {"biastype": "affine", "biasprm": texts(bias)}
        if -math.inf < drive.limits[0] < drive.limits[1] < math.inf:
            servo["ctrlrange"] = texts(drive.limits)
        SubElement(element, "general", {"name": drive.name, "tendon": drive.name} | servo)


def _pose(place: Floats) -> dict[str, str]:
    """Where something is, as in MuJoCo."""
    axes = [*place[:3, 0].tolist(), *place[:3, 1].tolist()]
    turned = {} if np.array_equal(place[:3, :3], np.eye(3)) else {"xyaxes": texts(axes)}
    return {"pos": texts(place[:3, 3].tolist())} | turned
