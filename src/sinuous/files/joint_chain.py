"""A chain of revolute and prismatic joints that stands for a robot of arcs, for programs that know such joints alone.

A segment of length l that bends by (ux, uy) becomes m turns, each between two halves of a link of length l / m. A turn
is a revolute joint about x, by -uy / m, and one about y, by ux / m. Finite turns do not commute, so their order
alternates: x y, y x, x y, ... (Strang's splitting), and what is left of it shrinks as the error of the polygon does,
with 1 / m^2. A link that stretches has a prismatic joint. Joints before the first segment are what they are. All joint
values are linear in the configuration.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import JointsAndBatch, Whole
from sinuous.base.checks import Floats, closed
from sinuous.base.frozen import Frozen, call
from sinuous.kernels.packing import BendLine
from sinuous.model.joints import Fixed, LinkCapsule, Prismatic
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
