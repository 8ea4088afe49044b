"""Judge an answer by an independent, slow path: what `sinuous.measures` computes. `verify` uses no kernel.

`find_worst` does: it only says of a failure what is missing, and has to be quick, also among large meshes. Its values
are the same but for how densely the body is held against itself.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from sinuous.arguments import Constraint
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.measures.body import SAMPLES, Meeting, least_clearance, least_self_clearance, segment_ends
from sinuous.measures.reach import target_errors
from sinuous.reprs import ShortRepr, call
from sinuous.robot.limits import unit_of
from sinuous.scene.nearest import least_gap
from sinuous.solution.binding.contacts import self_contacts_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sinuous.problem.problem import Problem
    from sinuous.problem.target import Target, Tolerance
    from sinuous.robot.robot import Robot
    from sinuous.scene.snapshot import Snapshot

LIMIT_SLACK = 1e-9
"""By how much a limit may be exceeded: rad, or mean lengths of the robot."""

ROUNDING = 1e-9
"""What rounding may add to an error, relative to the robot's length."""


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
        By how much it is missed: beyond the tolerance for `position` (length) and `angle` (rad); the depth of overlap
        for `clearance` and `self_clearance` (length); beyond the limit for the others (length; rad for `bend` and
        `curvature`).
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
        where = "" if self.segment is None else f" of segment {self.segment}"
        what = "" if self.obstacle is None else f" at {self.obstacle}"
        return f"{self.constraint}{where}{what} by {self.amount:.3g}"


@dataclass(frozen=True, repr=False)
class Verification(ShortRepr):
    """What the slow path found.

    Attributes
    ----------
    ok : bool
        Targets met, limits kept, no place of the body inside an obstacle, and none inside the body elsewhere.
    position_error, angle_error : float
        Largest over the targets; 0 where nothing is asked.
    excess : float
        By how much the limits are exceeded; 0 within.
    clearance : float
        Least over the sampled places: the true clearance is at most this. Infinite without obstacles.
    segment, obstacle : int or None, str or None
        Where the least clearance is: segment (1 = first) and name of the obstacle.
    self_clearance : float
        Least distance of the body from itself over the sampled places: the true one is at most this. Infinite where it
        does not matter: the body may run through itself, or is too short to.
    self_segments : (int, int) or None
        The two segments that are nearest to each other, 1 = first.
    """

    ok: bool
    position_error: float
    angle_error: float
    excess: float
    clearance: float
    segment: int | None
    obstacle: str | None
    self_clearance: float
    self_segments: tuple[int, int] | None

    def _shown(self) -> Iterator[str]:
        yield f"ok={self.ok}"
        for name in ("position_error", "angle_error", "excess", "clearance", "self_clearance"):
            yield f"{name}={getattr(self, name):.3g}"


@dataclass(frozen=True, eq=False, repr=False)
class Verifications:
    """What the slow path found of many shapes; every attribute is an array (...), see `Verification`.

    Attributes
    ----------
    ok : ndarray of bool
    position_error, angle_error, excess, clearance, self_clearance : ndarray
    segment, obstacle, self_segments : ndarray of object
        With None where a single one has it.
    """

    ok: NDArray[np.bool_]
    position_error: Floats
    angle_error: Floats
    excess: Floats
    clearance: Floats
    segment: NDArray[np.object_]
    obstacle: NDArray[np.object_]
    self_clearance: Floats
    self_segments: NDArray[np.object_]

    def __repr__(self) -> str:
        return call("Verifications", [f"{int(self.ok.sum())} of {self.ok.size} ok"])


def verify(problem: "Problem", q: Floats) -> Verification:
    """Recompute errors, limits and clearances of the configuration `q` (n, 3) for `problem`."""
    return verified(problem.robot, q, problem.scene, problem.targets, problem.tolerance)


def verified(
    robot: "Robot", q: Floats, scene: "Snapshot", targets: "Sequence[Target]", tolerance: "Tolerance"
) -> Verification:
    """Recompute errors, limits and clearances of a configuration `q` (n, 3); there may be no targets."""
    ends = segment_ends(robot, q)
    errors = [target_errors(robot, target, ends) for target in targets]
    off, turn = (max((error[i] for error in errors), default=0.0) for i in (0, 1))
    clearance, segment, obstacle = least_clearance(robot, scene, q, ends)
    itself = _meeting(robot, q, ends)
    excess = robot.excess(q)
    slack = ROUNDING * robot.mean_length
    ok = (
        off <= (tolerance.position or 0.0) + slack
        and turn <= tolerance.angle + 1e-7
        and all(amount <= LIMIT_SLACK * unit_of(limit, robot.mean_length) for limit, _, amount in robot.violations(q))
        and clearance >= -slack
        and itself.gap >= -slack
    )
    return Verification(ok, off, turn, excess, clearance, segment, obstacle, *itself)


def _meeting(robot: "Robot", q: Floats, ends: Floats) -> Meeting:
    """Where the body is nearest to itself, if that matters."""
    return least_self_clearance(robot, q, ends) if robot.avoids_itself else Meeting(math.inf, None)


def find_worst(problem: "Problem", q: Floats, overlap: bool) -> Worst:
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


def find_overlap(robot: "Robot", scene: "Snapshot", q: Floats) -> Worst:
    """The deepest overlap of `q` (n, 3) with an obstacle or with itself; its amount is not positive without any."""
    ends = np.concatenate([robot.base[None], robot.forward(q)])
    clearance, itself = _least_clearance(robot, scene, q), _meeting(robot, q, ends)
    return max(_as_worst(clearance, itself), key=lambda worst: worst.amount)


def _overlaps(problem: "Problem", q: Floats, ends: Floats | None) -> tuple[Worst, Worst]:
    """How deep the body overlaps obstacles, and itself.

    With the frames of all `ends` (n + 1, 4, 4) it is known that it does one of both, and it is looked for with care.
    """
    clearance = _least_clearance(problem.robot, problem.scene, q)
    itself = _seen(problem, q)
    if ends is not None and min(clearance[0], itself[0]) > 0.0:
        itself = _meeting(problem.robot, q, ends)
    return _as_worst(clearance, itself)


def _as_worst(clearance: tuple[float, int | None, str | None], itself: Meeting) -> tuple[Worst, Worst]:
    distance, where, which = clearance
    gap, segments = itself
    near, far = segments or (None, None)
    return Worst("clearance", where, which, -distance), Worst("self_clearance", far, None, -gap, near)


def _seen(problem: "Problem", q: Floats) -> Meeting:
    """Where the body touches itself, as far as fewer places show it than `_meeting` looks at, in less time."""
    contacts = self_contacts_of(problem, q)
    if not contacts:
        return Meeting(math.inf, None)
    deepest = contacts[0]
    return Meeting(deepest.clearance, (deepest.other_segment or deepest.segment, deepest.segment))


def _least_clearance(robot: "Robot", scene: "Snapshot", q: Floats) -> tuple[float, int | None, str | None]:
    """Least clearance, its segment (1 = first) and obstacle: as `measures.clearance.least_clearance`, but compiled."""
    if len(scene) == 0:
        return math.inf, None, None
    points, lengths = robot.backbone(q, SAMPLES), q[:, 2]
    # The end of a segment is the beginning of the next one, which may be thicker: it counts for both.
    places = np.arange(SAMPLES * len(robot)).reshape(-1, SAMPLES)[:, :1] + np.arange(SAMPLES + 1)
    before = np.concatenate([[0.0], np.cumsum(lengths)[:-1]])
    free = before[:, None] + np.linspace(0.0, lengths, SAMPLES + 1, axis=-1) >= robot.mount
    segments = np.broadcast_to(np.arange(len(robot))[:, None], free.shape)[free]
    nearest = least_gap(points[places[free]], np.array(robot.radii)[segments], scene)
    segment = None if nearest.place is None else int(segments[nearest.place]) + 1
    return nearest.distance, segment, nearest.obstacle
