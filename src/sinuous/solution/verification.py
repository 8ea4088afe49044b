"""Judge an answer by an independent, slow path: what `sinuous.measures` computes. No kernel is used."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sinuous.checks import Floats
from sinuous.measures.body import segment_ends
from sinuous.measures.clearance import least_clearance
from sinuous.measures.targets import target_errors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sinuous.problem.problem import Problem
    from sinuous.problem.target import Target
    from sinuous.problem.tolerance import Tolerance
    from sinuous.robot.robot import Robot
    from sinuous.scene.snapshot import Snapshot

LIMIT_SLACK = 1e-9
ROUNDING = 1e-9
"""What rounding may add to an error, relative to the robot's length."""


@dataclass(frozen=True)
class Worst:
    """The constraint that is farthest from being met.

    Attributes
    ----------
    constraint : str
        `position`, `angle`, `clearance`, or a limit: `length`, `bend`, `curvature`, `actuator`.
    segment : int or None
        Segment where it is, 1 = first.
    obstacle : str or None
        Name of the obstacle, for `clearance`.
    amount : float
        By how much it is missed: beyond the tolerance for `position` (length) and `angle` (rad); the depth of overlap
        for `clearance` (length); beyond the limit for the others (length; rad for `bend` and `curvature`).
    """

    constraint: str
    segment: int | None
    obstacle: str | None
    amount: float

    def __str__(self) -> str:
        where = "" if self.segment is None else f" of segment {self.segment}"
        what = "" if self.obstacle is None else f" at {self.obstacle}"
        return f"{self.constraint}{where}{what} by {self.amount:.3g}"


@dataclass(frozen=True)
class Verification:
    """What the slow path found; of many shapes (see `check`) every attribute is an array.

    Attributes
    ----------
    ok : bool
        Targets met, limits kept, and no place of the body inside an obstacle.
    position_error, angle_error : float
        Largest over the targets; 0 where nothing is asked.
    excess : float
        By how much the limits are exceeded; 0 within.
    clearance : float
        Least over the sampled places: the true clearance is at most this. Infinite without obstacles.
    segment, obstacle : int or None, str or None
        Where the least clearance is: segment (1 = first) and name of the obstacle.
    """

    ok: bool
    position_error: float
    angle_error: float
    excess: float
    clearance: float
    segment: int | None
    obstacle: str | None


def verify(problem: "Problem", q: Floats) -> Verification:
    """Recompute errors, limits and clearance of the configuration `q` (n, 3) for `problem`."""
    return verified(problem.robot, q, problem.scene, problem.targets, problem.tolerance)


def verified(
    robot: "Robot", q: Floats, scene: "Snapshot", targets: "Sequence[Target]", tolerance: "Tolerance"
) -> Verification:
    """Recompute errors, limits and clearance of a configuration `q` (n, 3); there may be no targets."""
    ends = segment_ends(robot, q)
    errors = [target_errors(robot, target, ends) for target in targets]
    off, turn = (max((error[i] for error in errors), default=0.0) for i in (0, 1))
    clearance, segment, obstacle = least_clearance(robot, scene, q, ends)
    excess = robot.excess(q)
    slack = ROUNDING * robot.mean_length
    ok = (
        off <= (tolerance.position or 0.0) + slack
        and turn <= tolerance.angle + 1e-7
        and excess <= LIMIT_SLACK * max(1.0, robot.mean_length)
        and clearance >= -slack
    )
    return Verification(ok, off, turn, excess, clearance, segment, obstacle)


def find_worst(problem: "Problem", q: Floats, overlap: bool) -> Worst:
    """The constraint that `q` (n, 3) is farthest from meeting, lengths relative to the robot's length.

    With `overlap` it is known to be the clearance, however deep.
    """
    robot, tolerance = problem.robot, problem.tolerance
    ends = segment_ends(robot, q)
    unit = robot.mean_length
    clearance, where, which = least_clearance(robot, problem.scene, q, ends)
    blocked = Worst("clearance", where, which, -clearance)
    if overlap:
        return blocked
    found = [(-clearance / unit, blocked)]
    for name, segment, amount in robot.violations(q):
        found.append((amount / (1.0 if name in ("bend", "curvature") else unit), Worst(name, segment, None, amount)))
    for target in problem.targets:
        off, turn = target_errors(robot, target, ends)
        segment = len(robot) if target.segment is None else target.segment
        miss, twist = off - (tolerance.position or 0.0), turn - tolerance.angle
        found.append((miss / unit, Worst("position", segment, None, miss)))
        found.append((twist, Worst("angle", segment, None, twist)))
    return max(found, key=lambda pair: pair[0])[1]
