"""What may be fitted: groups of parameters, how far drawings are usually off, and the robot with other values."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.model.actuators import Actuators, Lines
from sinuous.model.joints import Joint, Prismatic, moved_joints
from sinuous.model.loads import Payload
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment, Stiffness
from sinuous.statics.response import softest

GroupName = Literal[
    "base",
    "device",
    "stretch",
    "stiffness",
    "payload",
    "rest",
    "offsets",
    "lengths",
    "circles",
    "angles",
    "gains",
    "tool",
    "joints",
]
"""Groups of parameters."""

GROUPS: tuple[GroupName, ...] = get_args(GroupName)

WIDTHS: dict[GroupName, float] = {
    "base": 1e3,
    "device": 1e3,
    "tool": 0.1,
    "stretch": 1.0,
    "offsets": 0.02,
    "joints": 0.05,
    "stiffness": 1.0,
    "payload": 1.0,
    "rest": 0.5,
    "lengths": 0.1,
    "circles": 0.3,
    "angles": 0.3,
    "gains": 0.1,
}
"""How far a drawing may well be off: logarithms of ratios; rad; of `offsets`, `tool` and sliding `joints` lengths of
the robot; of `payload` masses that bend the softest segment by 1 rad, carried by a lever as long as the robot."""

ORDER: tuple[GroupName, ...] = tuple(name for name in WIDTHS if name not in ("base", "device", "tool"))
"""In which order groups are tried: that of `WIDTHS`."""

SOFTNESS_RATIO = 3.0
"""Where a robot has rigid tendons: ratio of the stiffness of a tendon times its lever squared to that of its segment,
from which a fit of elastic ones begins."""


def lines_of(robot: Robot) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The tendons and chambers (e,): places among all actuators, and which of the robot's sets of lines each is of."""
    rows, at, number = list[tuple[int, int]](), 0, 0
    for segment in robot.segments:
        for lines in (segment.tendons, segment.chambers):
            if lines is not None:
                rows += [(at + j, number) for j in range(len(lines.angles))]
                at, number = at + len(lines.angles), number + 1
        at += segment.stage is not None
    places, sets = np.array(rows, np.intp).reshape(-1, 2).T
    return places, sets


def elastic(robot: Robot) -> Robot:
    """The same robot with tendons that stretch, where they are rigid: softness to begin a fit with.

    Where no segment has a stiffness, the unit of force is such that all tendons have a stiffness of 1.
    """
    softness = [_lever(robot, segment) ** 2 * 0.5 * sum(segment.length) / SOFTNESS_RATIO for segment in robot.segments]
    own = [
        segment.stiffness.bend / each
        for segment, each in zip(robot.segments, softness, strict=True)
        if segment.stiffness is not None and each > 0.0
    ]
    pull = float(np.median(own)) if own else 1.0
    segments = []
    for segment, each in zip(robot.segments, softness, strict=True):
        tendons = None if segment.tendons is None else segment.tendons.changed(stiffness=pull)
        bends = segment.stiffness is None and segment.max_bend > 0.0 and each > 0.0
        stiffness = Stiffness(pull * each) if bends else segment.stiffness
        segments.append(segment.changed(tendons=tendons, stiffness=stiffness))
    return robot.changed(segments=segments)


def _lever(robot: Robot, segment: Segment) -> float:
    own = [each.tendons.radius for each in (segment, *robot.segments) if each.tendons is not None]
    return own[0] if own else 0.0


def can_stretch(robot: Robot) -> bool:
    """Whether tendons may be made elastic: there are some, all of them rigid, and nothing else bends the robot."""
    moving, matrix = len(robot.joint_names), None if robot.linear is None else robot.linear.matrix
    linear = matrix is not None and matrix[:, moving:].reshape(len(matrix), -1, 3)[..., :2].any()
    chambers = any(segment.chambers is not None for segment in robot.segments)
    tendons = any(segment.tendons is not None for segment in robot.segments)
    return tendons and robot.drive.elastic is None and not linear and not chambers


class ParameterGroup(NamedTuple):
    """A group of parameters: its name, those of its parameters, how far each may be off, and their least values."""

    name: GroupName
    names: tuple[str, ...]
    widths: Floats
    lowest: Floats


def group(robot: Robot, name: GroupName) -> ParameterGroup:
    """The parameters of a group for a robot; none where the robot has none of these."""
    names = tuple(_names(robot, name))
    width, lowest = WIDTHS[name], np.full(len(names), -np.inf)
    if name in ("offsets", "tool"):
        width *= robot.mean_length
    elif name == "payload" and robot.gravity is not None and names:
        width *= softest(robot) / (robot.mean_length * float(np.linalg.norm(robot.gravity)))
        lowest = -np.array([payload.mass for payload in carried(robot)])
    widths = np.full(len(names), width)
    if name == "joints":
        widths[[isinstance(joint, Prismatic) for joint in robot._rigid.moving]] *= robot.mean_length
    return ParameterGroup(name, names, widths, lowest)


def with_joint_motors(robot: Robot) -> Robot:
    """Return the robot whose joints are actuators of their own names, where no other actuator determines them."""
    names, where = robot.joint_names, robot._rigid.flat(len(robot))
    loose = np.flatnonzero(robot._inverse.undetermined.ravel()[where[: len(names)]]).tolist()
    if not loose:
        return robot
    own = Actuators(np.eye(len(where))[loose], [names[i] for i in loose])
    if robot.linear is not None:
        both, count = (robot.linear, own), len(robot.linear.names)
        motors = {key: np.concatenate([getattr(each.motors, key) for each in both]) for key in ("gain", "offset")}
        own = Actuators(
            np.concatenate([each.matrix for each in both]),
            (*robot.linear.names, *own.names),
            [*robot.linear.limits, *own.limits],
            unit=(*robot.linear.motors.unit[:count], *own.motors.unit),
            **motors,
        )
    return robot.changed(actuators=own)


def carried(robot: Robot) -> tuple[Payload, ...]:
    """What a robot carries: where nothing was drawn, a payload at its tip without mass."""
    return robot.payload or (Payload(0.0),)


def _names(robot: Robot, name: GroupName) -> Iterator[str]:
    soft = _gives(robot)
    segments = list(zip(robot.segments, robot.segment_names, strict=True))
    lines = [(s, n, kind) for s, n in segments for kind in ("tendons", "chambers") if getattr(s, kind) is not None]
    match name:
        case "base" | "device":
            yield from (f"{name} {part}" for part in ("turn x", "turn y", "turn z", "x", "y", "z"))
        case "payload":
            count = len(carried(robot)) if robot.has_external_load else 0
            yield from ("mass of the payload" if count == 1 else f"mass of payload[{i}]" for i in range(count))
        case "tool":
            yield from (f"tool {axis}" for axis in "xyz")
        case "stiffness":
            yield from (f"stiffness of {n}" for s, n in segments if soft and is_soft(s))
        case "rest":
            yield from (f"rest bend_{axis} of {n}" for s, n in segments if soft and is_soft(s) for axis in "xy")
        case "lengths":
            yield from (f"length of {n}" for s, n in segments if is_fixed(s))
        case "joints":
            yield from (f"offset of joint {name!r}" for name in robot.joint_names)
        case "offsets":
            yield from (f"offset of {robot.actuators[place].name}" for place in lines_of(robot)[0])
        case _:
            word = {"stretch": "stretch", "circles": "circle", "angles": "angle", "gains": "gain"}[name]
            stretch = robot.drive.elastic is not None
            yield from (f"{word} of {kind} of {n}" for _, n, kind in lines if stretch or name != "stretch")


def is_fixed(segment: Segment) -> bool:
    """Whether the length of a segment may be fitted: it has one that does not change."""
    return not segment.rigid and segment.length[0] == segment.length[1] > 0.0


def is_soft(segment: Segment) -> bool:
    """Whether the stiffness of a segment, and its bend at rest, may be fitted."""
    return segment.stiffness is not None and segment.max_bend > 0.0


def _gives(robot: Robot) -> bool:
    """Whether shapes depend on the stiffness of segments: tendons that stretch, or weight, work against it."""
    return robot.drive.elastic is not None or robot.has_external_load


@dataclass(frozen=True)
class Values:
    """Parameters of all groups that are fitted: changes of the drawing; see `WIDTHS` for what they count."""

    groups: tuple[ParameterGroup, ...]
    x: Floats

    def of(self, name: GroupName) -> Floats | None:
        """Those of one group, or None where it is not fitted."""
        columns = self.columns(name)
        return None if columns is None else self.x[columns]

    def columns(self, name: GroupName) -> slice | None:
        """Where those of one group are in `x`, or None."""
        at = 0
        for each in self.groups:
            if each.name == name:
                return slice(at, at + len(each.names))
            at += len(each.names)
        return None

    def with_x(self, x: Floats) -> "Values":
        """Other values of the same parameters."""
        return replace(self, x=x)

    @property
    def widths(self) -> Floats:
        """How far each may well be off."""
        return np.concatenate([np.zeros(0), *(each.widths for each in self.groups)])

    @property
    def lowest(self) -> Floats:
        """The least value of each."""
        return np.concatenate([np.zeros(0), *(each.lowest for each in self.groups)])


def changed(robot: Robot, values: Values) -> Robot:
    """The robot with these changes, but for the pose of its base and its tool."""
    parts = {name: values.of(name) for name in GROUPS}
    sets, stiff, fixed, first = 0, 0, 0, 0
    segments = []
    for segment in robot.segments:
        new: dict[str, Any] = {}
        if is_fixed(segment):
            if (own := parts["lengths"]) is not None:
                new["length"] = segment.length[0] * math.exp(own[fixed])
            fixed += 1
        if _gives(robot) and segment.stiffness is not None and segment.max_bend > 0.0:
            if (own := parts["stiffness"]) is not None:
                factor, rod = math.exp(own[stiff]), segment.stiffness
                stiffer = {key: factor * getattr(rod, key) for key in ("bend", "twist")}
                new["stiffness"] = rod._changed({key: value for key, value in stiffer.items() if value < math.inf})
            if (own := parts["rest"]) is not None:
                new["rest"] = segment.rest + own[2 * stiff : 2 * stiff + 2]
            stiff += 1
        for kind in ("tendons", "chambers"):
            lines = getattr(segment, kind)
            if lines is not None:
                count = len(lines.angles)
                new[kind] = _changed_lines(lines, parts, sets, slice(first, first + count))
                sets, first = sets + 1, first + count
        segments.append(segment.changed(**new))
    payload = robot.payload
    if (own := parts["payload"]) is not None:
        listed = zip(carried(robot), own, strict=True)
        payload = tuple(each.changed(mass=each.mass + float(more)) for each, more in listed)
    joints: Sequence[Joint] = robot.joints
    if (own := parts["joints"]) is not None:
        joints = moved_joints(robot.joints, own)
    return robot.changed(segments=segments, payload=payload, joints=joints)


def _changed_lines(own: Lines, parts: Mapping[GroupName, Floats | None], which: int, places: slice) -> Lines:
    """One set of lines, the tendons or chambers of a segment, with its changes."""
    new: dict[str, Any] = {}
    gain = np.full(len(own.angles), own.gain)
    if (gains := parts["gains"]) is not None:
        gain = gain * math.exp(-gains[which])
        new["gain"] = gain
    if (offsets := parts["offsets"]) is not None:
        new["offset"] = own.offset - gain * offsets[places]
    if (circles := parts["circles"]) is not None:
        new["radius"] = own.radius * math.exp(circles[which])
    if (angles := parts["angles"]) is not None:
        new["angles"] = own.angles + angles[which]
    if (stretch := parts["stretch"]) is not None and own.stiffness is not None:
        new["stiffness"] = own.stiffness * math.exp(stretch[which])
    return own.changed(**new)
