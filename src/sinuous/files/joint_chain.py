"""A chain of revolute and prismatic joints that stands for a robot of arcs, for programs that know such joints alone.

A segment of length l that bends by (ux, uy) becomes m turns, each between two halves of a link of length l / m. A turn
is a revolute joint about x, by -uy / m, and one about y, by ux / m. Finite turns do not commute, so their order
alternates: x y, y x, x y, ... (Strang's splitting), and what is left of it shrinks as the error of the polygon does,
with 1 / m^2. A link that stretches has a prismatic joint. All joint values are linear in the configuration.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Batch, Whole
from sinuous.base.checks import Floats
from sinuous.base.frozen import Frozen, call
from sinuous.kernels.packing import BendLine

if TYPE_CHECKING:
    from sinuous.model.robot import Robot

MOST_TURNS = 1000

Axis = Literal["x", "y", "z"]


@dataclass(frozen=True)
class Link:
    """A rigid piece of the chain: cylinders along its z axis, from one height to another, and balls on it."""

    cylinders: list[tuple[float, float, float]] = field(default_factory=list)
    """From, to, radius."""
    balls: list[tuple[float, float]] = field(default_factory=list)
    """Height, radius."""


@dataclass(frozen=True)
class ChainJoint:
    """A joint, at a height on the z axis of the link before it, and the link that it moves.

    About x or y it turns, along z it slides; its value is `weight` times coordinate `coordinate` of the segment.
    """

    name: str
    axis: Axis
    height: float
    segment: int
    coordinate: int
    weight: float
    limits: tuple[float, float]
    link: Link = field(default_factory=Link)


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
        `s1_1_x` is the first turn of segment `s1` about x, `s1_1_z` its first stretch.
    first : Link
        The piece before the first joint.
    end : float
        Height of the tip on the z axis of the last link.
    """

    robot: "Robot"
    joints_per_segment: int
    joints: tuple[ChainJoint, ...]
    first: Link
    end: float

    def __init__(self, robot: "Robot", joints_per_segment: Whole = 8) -> None:
        count = checks.integer("joints_per_segment", joints_per_segment, 1, MOST_TURNS)
        build = _Build(robot, count)
        self._set(
            robot=robot, joints_per_segment=count, joints=tuple(build.joints), first=build.first, end=build.height
        )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all joints, base to tip."""
        return tuple(joint.name for joint in self.joints)

    @cached_property
    def matrix(self) -> Floats:
        """Derivative (j, 3 n) of the joint values by the configuration: they are this times the flat configuration."""
        result = np.zeros((len(self.joints), 3 * len(self.robot)))
        for i, joint in enumerate(self.joints):
            result[i, 3 * joint.segment + joint.coordinate] = joint.weight
        result.flags.writeable = False
        return result

    def values(self, q: Batch) -> Floats:
        """ChainJoint values (..., j) of configurations (..., n, 3): rad, and lengths."""
        checked = checks.stack("q", q, (len(self.robot), 3))
        return checked.reshape(*checked.shape[:-2], -1) @ self.matrix.T

    def __len__(self) -> int:
        return len(self.joints)

    def __repr__(self) -> str:
        return call("JointChain", [f"{len(self)} joints", f"{len(self.robot)} segments"])


class _Build:
    """Joints and links while they are put together."""

    def __init__(self, robot: "Robot", count: int) -> None:
        self.joints: list[ChainJoint] = []
        self.first = self.link = Link()
        self.height = 0.0
        for k in range(len(robot)):
            self.radius = robot.radii[k]
            name, (low, high) = robot.segment_names[k], robot.drive.coordinates.lengths[k].tolist()
            most = min(robot.largest_bends[k], robot.curvatures[k] * high)
            if high == 0.0:
                continue
            limits = _bends_of(robot.drive.coordinates.bends[k], most)
            for i, (share, turns) in enumerate(_pieces(count if most > 0.0 else 0), 1):
                self.stretch(f"{name}_{i}_z", k, share, (low, high))
                for axis in turns:
                    self.turn(f"{name}_{i}_{axis}", k, axis, count, limits[0 if axis == "y" else 1])
        self.link.balls.append((self.height, self.radius))

    def stretch(self, name: str, segment: int, share: float, length: tuple[float, float]) -> None:
        """Go on along z by a share of the length of a segment."""
        low, high = share * length[0], share * length[1]
        self.link.balls.append((self.height, self.radius))
        if low == high:
            self.link.cylinders.append((self.height, self.height + high, self.radius))
            self.height += high
            return
        self.link.cylinders.append((self.height, self.height + 0.5 * high, self.radius))
        self.join(ChainJoint(name, "z", self.height, segment, 2, share, (low, high)))
        self.link.cylinders.append((-0.5 * high, 0.0, self.radius))

    def turn(self, name: str, segment: int, axis: Axis, count: int, bend: tuple[float, float]) -> None:
        """Turn by a share of the bend of a segment, which lies between two; there is no joint where it is always 0."""
        if bend == (0.0, 0.0):
            return
        coordinate, weight = (1, -1.0 / count) if axis == "x" else (0, 1.0 / count)
        low, high = sorted(weight * each for each in bend)
        self.join(ChainJoint(name, axis, self.height, segment, coordinate, weight, (low, high)))

    def join(self, joint: ChainJoint) -> None:
        self.joints.append(joint)
        self.link, self.height = joint.link, 0.0


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
