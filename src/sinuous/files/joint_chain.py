"""A chain of revolute and prismatic joints that stands for a robot of arcs, for programs that know such joints alone.

A segment of length l that bends by (ux, uy) becomes m turns, each between two halves of a link of length l / m. A turn
is a revolute joint about x, by -uy / m, and one about y, by ux / m. Finite turns do not commute, so their order
alternates: x y, y x, x y, ... (Strang's splitting), and what is left of it shrinks as the error of the polygon does,
with 1 / m^2. A link that stretches has a prismatic joint. Joints before the first segment are what they are. All joint
values are linear in the configuration.

Trajectories of joints as ROS 2 has them: `trajectory_msgs/JointTrajectory` as JSON.

A chain of joints as URDF, the robot description of ROS, which RViz, MuJoCo and PyBullet load.

Shapes are cylinders and balls of the radius of the body. Masses are nominal, one unit a link: the file is meant for
kinematics, pictures and collision checks, not for dynamics. An arm without a radius has shapes to look at, and none
that collide.
"""

import json
import math
from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal
from xml.etree.ElementTree import Comment, Element, SubElement

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import JointsAndBatch, Whole
from sinuous.base.checks import Floats, closed, written
from sinuous.base.documents import write_xml
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, call
from sinuous.kernels.packing import BendLine
from sinuous.model.joints import Fixed, LinkCapsule, Prismatic
from sinuous.model.limits import OF_ONE_SEGMENT
from sinuous.model.poses import pose

if TYPE_CHECKING:
    from sinuous.model.robot import Robot

MOST_TURNS = 1000

Axis = Literal["x", "y", "z"]


@dataclass(frozen=True)
class Link:
    """A rigid piece of the chain: cylinders and balls, in its frame."""

    cylinders: list[LinkCapsule] = field(default_factory=list)
    """Without the balls at their ends."""
    balls: list[tuple[Floats, float]] = field(default_factory=list)
    """Place (3,), radius."""

    def add_capsule(self, capsule: LinkCapsule, pose: Floats) -> None:
        """Add a capsule that is given in another frame."""
        start, end = (pose[:3, :3] @ point + pose[:3, 3] for point in (capsule.start, capsule.end))
        self.balls.append((start, capsule.radius))
        if not np.array_equal(start, end):
            self.cylinders.append(LinkCapsule(start, end, capsule.radius))
            self.balls.append((end, capsule.radius))


@dataclass(frozen=True)
class ChainJoint:
    """A joint, where it is in the frame of the link before it, and the link that it moves.

    It turns about its axis or slides along it; its value is `weight` times coordinate `coordinate` of row `segment` of
    the configuration, and `offset`.
    """

    name: str
    slides: bool
    axis: tuple[float, float, float]
    origin: Floats
    segment: int
    coordinate: int
    weight: float
    limits: tuple[float, float]
    offset: float = 0.0
    rate: float = math.inf
    link: Link = field(default_factory=Link)


AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


class JointChain(Frozen):
    """Joints that stand for the segments of a robot, base to tip.

    Parameters
    ----------
    robot : Robot
    joints_per_segment : int
        How many turns stand for the bend of a segment; each is a joint about x and one about y.

    Attributes
    ----------
    joints : tuple of ChainJoint
        First those before the first segment. `s1_1_x` is the first turn of segment `s1` about x, `s1_1_z` its first
        stretch.
    first : Link
        The piece before the first joint.
    tip : ndarray (4, 4)
        Pose of the tip in the frame of the last link.
    """

    robot: "Robot"
    joints_per_segment: int
    joints: tuple[ChainJoint, ...]
    first: Link
    tip: Floats

    def __init__(self, robot: "Robot", joints_per_segment: Whole = 8) -> None:
        count = checks.integer("joints_per_segment", joints_per_segment, 1, MOST_TURNS)
        build = _Build(robot, count)
        self._set(robot=robot, joints_per_segment=count, joints=tuple(build.joints), first=build.first)
        self._set(tip=closed(build.ahead))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all joints, base to tip."""
        return tuple(joint.name for joint in self.joints)

    @property
    def end(self) -> float:
        """Height of the tip on the z axis of the last link."""
        return float(self.tip[2, 3])

    @cached_property
    def offsets(self) -> Floats:
        """Values (j,) of the joints where all numbers of a configuration are 0."""
        return closed(np.array([joint.offset for joint in self.joints]))

    @cached_property
    def matrix(self) -> Floats:
        """Derivative (j, 3 n) of the joint values by the configuration: they are it times the latter, and `offsets`."""
        result = np.zeros((len(self.joints), 3 * len(self.robot)))
        for i, joint in enumerate(self.joints):
            result[i, 3 * joint.segment + joint.coordinate] = joint.weight
        result.flags.writeable = False
        return result

    def values(self, q: JointsAndBatch) -> Floats:
        """Joint values (..., j) of configurations (..., n, 3): rad, and lengths."""
        checked = self.robot.configuration("q", q)
        return checked.reshape(*checked.shape[:-2], -1) @ self.matrix.T + self.offsets

    def __len__(self) -> int:
        return len(self.joints)

    def __repr__(self) -> str:
        return call("JointChain", [f"{len(self)} joints", f"{len(self.robot.segments)} segments"])


class _Build:
    """Joints and links while they are put together; `ahead` is where the next piece begins in the frame of the link."""

    def __init__(self, robot: "Robot", count: int) -> None:
        self.joints: list[ChainJoint] = []
        self.first = self.link = Link()
        self.ahead = np.eye(4)
        self.add_joints(robot)
        for k in range(len(robot.rows) - len(robot.segments), len(robot)):
            self.radius = robot.radii[k]
            name, (low, high) = robot.row_names[k], robot.drive.coordinates.lengths[k].tolist()
            most = min(robot.largest_bends[k], robot.curvatures[k] * high)
            if high == 0.0:
                continue
            limits = _bends_of(robot.drive.coordinates.bends[k], most)
            for i, (share, turns) in enumerate(_pieces(count if most > 0.0 else 0), 1):
                self.stretch(f"{name}_{i}_z", k, share, (low, high))
                for axis in turns:
                    self.turn(f"{name}_{i}_{axis}", k, axis, count, limits[0 if axis == "y" else 1])
        if robot.segments:
            self.add_ball()

    def add_joints(self, robot: "Robot") -> None:
        """Add the joints before the first segment, and their links."""
        rigid, moving = robot._rigid, 0
        for joint in robot.joints:
            self.ahead = self.ahead @ joint.origin
            if not isinstance(joint, Fixed):
                i, moving = moving, moving + 1
                self.join(
                    ChainJoint(
                        robot.joint_names[i],
                        isinstance(joint, Prismatic),
                        (float(joint.axis[0]), float(joint.axis[1]), float(joint.axis[2])),
                        self.ahead,
                        segment=int(rigid.values[i]),
                        coordinate=int(rigid.columns[i]),
                        weight=1.0,
                        limits=joint.limits,
                        offset=0.0 - float(rigid.shifts[i]),
                        rate=joint.rate,
                    )
                )
            for capsule in joint.body:
                self.link.add_capsule(capsule, self.ahead)

    def add_ball(self) -> None:
        """Add a ball of the body here."""
        self.link.balls.append((self.ahead[:3, 3], self.radius))

    def add_cylinder(self, low: float, high: float) -> None:
        """Add a cylinder of the body, from one height ahead of here to another."""
        start, end = ((self.ahead @ _lift(height))[:3, 3] for height in (low, high))
        self.link.cylinders.append(LinkCapsule(start, end, self.radius))

    def stretch(self, name: str, segment: int, share: float, length: tuple[float, float]) -> None:
        """Go on along z by a share of the length of a segment."""
        low, high = share * length[0], share * length[1]
        self.add_ball()
        if low == high:
            self.add_cylinder(0.0, high)
            self.ahead = self.ahead @ _lift(high)
            return
        self.add_cylinder(0.0, 0.5 * high)
        self.join(ChainJoint(name, True, AXES["z"], self.ahead, segment, 2, share, (low, high)))
        self.add_cylinder(-0.5 * high, 0.0)

    def turn(self, name: str, segment: int, axis: Axis, count: int, bend: tuple[float, float]) -> None:
        """Turn by a share of the bend of a segment, which lies between two; there is no joint where it is always 0."""
        if bend == (0.0, 0.0):
            return
        coordinate, weight = (1, -1.0 / count) if axis == "x" else (0, 1.0 / count)
        low, high = sorted(weight * each for each in bend)
        self.join(ChainJoint(name, False, AXES[axis], self.ahead, segment, coordinate, weight, (low, high)))

    def join(self, joint: ChainJoint) -> None:
        """Add a joint, and go on at its link."""
        self.joints.append(joint)
        self.link, self.ahead = joint.link, np.eye(4)


def _lift(height: float) -> Floats:
    return pose((0.0, 0.0, height))


def _bends_of(bends: float | BendLine, most: float) -> list[tuple[float, float]]:
    """Least and largest bend_x and bend_y of a segment; those of a plane along an axis are 0 across it."""
    if isinstance(bends, BendLine):
        ends = bends.at(max(bends.low, -most)), bends.at(min(bends.high, most))
        return [(min(a, b), max(a, b)) for a, b in zip(*ends, strict=True)]
    return [(-most, most), (-most, most)]


def _pieces(turns: int) -> Iterator[tuple[float, tuple[Axis, ...]]]:
    """Yield the pieces of a segment: share of its length, and the axes of the turn at its end."""
    if turns == 0:
        yield 1.0, ()
        return
    yield 0.5 / turns, ("x", "y")
    for i in range(1, turns):
        yield 1.0 / turns, ("y", "x") if i % 2 else ("x", "y")
    yield 0.5 / turns, ()


NANO = 1_000_000_000
"""Nanoseconds of a second."""

Of = Literal["joints", "actuators"]
"""Whose values a trajectory has: joints of the chain, as in the URDF, or actuators of the robot."""


def joint_trajectory(
    names: Sequence[str], times: Floats, positions: Floats, velocities: Floats | None = None
) -> dict[str, Any]:
    """Return the message as plain values; times count from the first.

    Parameters
    ----------
    names : sequence of str
        Names of the joints (j,).
    times : ndarray (T,)
        Seconds.
    positions, velocities : ndarray (T, j)
        A controller of ROS 2 moves along straight lines between positions alone, and along cubic splines where there
        are velocities.
    """
    begin = float(times[0])
    points = []
    for i, time in enumerate(times.tolist()):
        seconds, nanoseconds = divmod(round((time - begin) * NANO), NANO)
        point: dict[str, Any] = {"positions": positions[i].tolist()}
        if velocities is not None:
            point["velocities"] = velocities[i].tolist()
        points.append(point | {"time_from_start": {"sec": seconds, "nanosec": nanoseconds}})
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base"}
    return {"header": header, "joint_names": list(names), "points": points}


def write_json(file: str | Path, values: dict[str, Any]) -> None:
    """Write plain values as JSON.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    with written(file):
        Path(file).write_text(json.dumps(values, allow_nan=False) + "\n", encoding="utf-8")


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
    note_limits(root, robot, {"length"})
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


def note_limits(root: Element, robot: "Robot", kept: Set[str]) -> None:
    """Say in a file which kinds of limits of the robot it does not keep, but for those `kept`."""
    tensions = {"tension"} if np.isfinite(robot.limit_set.tensions).any() else set()
    exact = kept if robot.segments else kept | OF_ONE_SEGMENT  # limits of joints are kept as they are
    if left := ", ".join(sorted((robot.limit_set.kinds | tensions) - exact)):
        problem = f"Joints are limited one by one, which does not keep limits of {left}"
        root.append(Comment(f" {problem}: see robot.violations "))


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
