"""The constraint that a configuration is farthest from meeting; by kernels, to be quick among large meshes too.

It only says what a failed solve is missing. Its values are those of `sinuous.measures`, except that fewer places of
the body are compared with each other.
"""

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from sinuous.answer.contacts import self_contacts_of
from sinuous.base.arguments import Constraint
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.reprs import ShortRepr
from sinuous.measures.body import SAMPLES, Meeting, NearestObstacle, nearest_meeting
from sinuous.measures.reach import target_errors
from sinuous.model.limits import unit_of
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.scene.snapshot import Snapshot, least_gap

WorstKind = Constraint | Literal["position", "angle"]
"""What may be worst."""


@dataclass(frozen=True, repr=False)
class Worst(ShortRepr):
    """The constraint that is farthest from being met.

    Attributes
    ----------
    constraint : str
        `position`, `angle`, `clearance`, `self_clearance`, or a limit: `length`, `bend`, `curvature`, `actuator`.
    segment : int or None
        Segment where it is, 1 = first.
    obstacle : str or None
        Name of the obstacle, for `clearance`.
    amount : float
        By how much it is missed: beyond the tolerance for `position` (length) and `angle` (rad); for
        `clearance` and `self_clearance` the depth of overlap, or what is missing of what is demanded (length); beyond
        the limit for the others (length; rad for `bend` and `curvature`).
    other_segment : int or None
        The segment that it touches, for `self_clearance`; not beyond `segment`.
    """

    constraint: WorstKind
    segment: int | None
    obstacle: str | None
    amount: float
    other_segment: int | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values, in the order of the file format."""
        keys = ("constraint", "segment", "obstacle", "amount", "other_segment")
        return {key: getattr(self, key) for key in keys}

    @classmethod
    def from_dict(cls, values: Any) -> "Worst":
        """Make it of plain values, as `to_dict` writes them.

        Raises
        ------
        InputError
            When they are none.
        """
        try:
            return cls(**values)
        except TypeError:
            raise InputError("worst", "", values, "a constraint that is not met") from None

    def __str__(self) -> str:
        if self.other_segment is not None:
            whom = "itself" if self.other_segment == self.segment else f"segment {self.other_segment}"
            return f"segment {self.segment} touches {whom}, {self.amount:.3g} too near"
        if self.obstacle is not None:
            whose = "the body" if self.segment is None else f"segment {self.segment}"
            return f"{whose} lacks {self.amount:.3g} of clearance from {self.obstacle}"
        where = "" if self.segment is None else f" of segment {self.segment}"
        beyond = "its tolerance" if self.constraint in ("position", "angle") else "its limit"
        return f"{self.constraint}{where} is {self.amount:.3g} beyond {beyond}"


def find_worst(problem: Problem, q: Floats, overlap: bool) -> Worst:
    """The constraint that `q` (n, 3) is farthest from meeting, lengths relative to the robot's length.

    With `overlap` it is known to be a clearance, however deep.
    """
    robot, tolerance = problem.robot, problem.tolerance
    ends = np.concatenate([robot.base[None], robot.forward(q)])
    unit = robot.mean_length
    found = [(worst.amount / unit, worst) for worst in _overlaps(problem, q, ends if overlap else None)]
    if overlap:
        return max(found, key=lambda pair: pair[0])[1]
    for name, segment, amount in robot.violations(q):
        found.append((amount / unit_of(name, unit), Worst(name, segment, None, amount)))
    for target in problem.targets:
        off, turn = target_errors(robot, target, ends)
        segment = len(robot) if target.segment is None else target.segment
        miss, twist = off - (tolerance.position or 0.0), turn - tolerance.angle
        found.append((miss / unit, Worst("position", segment, None, miss)))
        found.append((twist, Worst("angle", segment, None, twist)))
    return max(found, key=lambda pair: pair[0])[1]


def find_overlap(robot: Robot, scene: Snapshot, q: Floats) -> Worst:
    """The deepest overlap of `q` (n, 3) with an obstacle or with itself; its amount is not positive without any.

    Where only bounds of distances are known it overlaps what an upper bound says.
    """
    ends = np.concatenate([robot.base[None], robot.forward(q)])
    clearance, itself = compiled_clearance(robot, scene, q, above=True), nearest_meeting(robot, q, ends)
    return max(_as_worst(clearance, itself), key=lambda worst: worst.amount)


def _overlaps(problem: Problem, q: Floats, ends: Floats | None) -> tuple[Worst, Worst]:
    """How deep the body overlaps obstacles, and itself.

    With the frames of all `ends` (n + 1, 4, 4) it is known that it does one of both, and it is looked for with care.
    """
    clearance = compiled_clearance(problem.robot, problem.scene, q)
    itself = _seen(problem, q)
    if ends is not None and min(clearance.distance, itself.gap) > 0.0:
        itself = nearest_meeting(problem.robot, q, ends)
    return _as_worst(clearance, itself)


def _as_worst(clearance: NearestObstacle, itself: Meeting) -> tuple[Worst, Worst]:
    near, far = itself.segments or (None, None)
    distance, where, which = clearance
    return Worst("clearance", where, which, -distance), Worst("self_clearance", far, None, -itself.gap, near)


def _seen(problem: Problem, q: Floats) -> Meeting:
    """Where the body touches itself, as far as fewer places show it than `nearest_meeting` looks at, in less time."""
    contacts = self_contacts_of(problem, q)
    if not contacts:
        return Meeting(math.inf, None)
    deepest = contacts[0]
    return Meeting(deepest.clearance, (deepest.other_segment or deepest.segment, deepest.segment))


def compiled_clearance(robot: Robot, scene: Snapshot, q: Floats, above: bool = False) -> NearestObstacle:
    """Least clearance beyond what is demanded, its segment (1 = first) and obstacle: as `measures.body` has it."""
    if len(scene) == 0:
        return NearestObstacle(math.inf, None, None)
    points, lengths = robot.backbone(q, SAMPLES), q[:, 2]
    # The end of a segment is the beginning of the next one, which may be thicker: it counts for both.
    places = np.arange(SAMPLES * len(robot)).reshape(-1, SAMPLES)[:, :1] + np.arange(SAMPLES + 1)
    before = np.concatenate([[0.0], np.cumsum(lengths)[:-1]])
    free = before[:, None] + np.linspace(0.0, lengths, SAMPLES + 1, axis=-1) >= robot.mount
    segments = np.broadcast_to(np.arange(len(robot))[:, None], free.shape)[free]
    nearest = least_gap(points[places[free]], np.array(robot.needed_radii)[segments], scene, above)
    segment = None if nearest.place is None else int(segments[nearest.place]) + 1
    return NearestObstacle(nearest.distance, segment, nearest.obstacle)
