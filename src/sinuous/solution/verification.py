"""Check an answer by an independent, slow path: matrix exponentials, plain NumPy, dense sampling. No kernel is used."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.measures.obstacles import measure

if TYPE_CHECKING:
    from sinuous.problem.problem import Problem
    from sinuous.problem.target import Target
    from sinuous.robot.robot import Robot

SAMPLES = 200
"""Places on every segment where the body is looked at."""

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
    """What the slow path found.

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
    robot, tolerance = problem.robot, problem.tolerance
    ends = segment_ends(robot, q)
    errors = [target_errors(robot, target, ends) for target in problem.targets]
    off, turn = max(e[0] for e in errors), max(e[1] for e in errors)
    clearance, segment, obstacle = least_clearance(problem, q, ends)
    excess = robot.excess(q)
    slack = ROUNDING * robot.mean_length
    ok = (
        off <= (tolerance.position or 0.0) + slack
        and turn <= tolerance.angle + 1e-7
        and excess <= LIMIT_SLACK * max(1.0, robot.mean_length)
        and clearance >= -slack
    )
    return Verification(ok, off, turn, excess, clearance, segment, obstacle)


def arc_poses(q: Floats, pieces: int) -> Floats:
    """Poses (pieces + 1, 4, 4) along one segment `q` (3,), by powers of the exponential of its twist."""
    from scipy.linalg import expm  # noqa: PLC0415

    ux, uy, length = q
    twist = np.array([[0, 0, ux, 0], [0, 0, uy, 0], [-ux, -uy, 0, length], [0, 0, 0, 0]], np.float64)
    step = expm(twist / pieces)
    poses = [np.eye(4)]
    for _ in range(pieces):
        poses.append(poses[-1] @ step)
    return np.stack(poses)


def segment_ends(robot: "Robot", q: Floats) -> Floats:
    """Poses (n + 1, 4, 4) of the base and of the ends of all segments."""
    poses = [robot.base]
    for segment in q:
        poses.append(poses[-1] @ arc_poses(segment, 1)[1])
    return np.stack(poses)


def target_errors(robot: "Robot", target: "Target", ends: Floats) -> tuple[float, float]:
    """Distance to the target's position and angle (rad) to its orientation; 0 where nothing is asked."""
    at_tip = target.segment is None or target.segment == len(robot)
    pose = ends[-1] @ robot.tool if at_tip else ends[target.segment]
    off = turn = 0.0
    if target.position is not None:
        off = float(np.linalg.norm(pose[:3, 3] - target.position))
    if target.direction is not None:
        tangent = pose[:3, 2]
        turn = 2.0 * math.atan2(
            float(np.linalg.norm(tangent - target.direction)), float(np.linalg.norm(tangent + target.direction))
        )
    elif target.rotation is not None:
        # The chord between two rotations is 2 sqrt(2) sin(angle / 2); this keeps small angles exact.
        chord = float(np.linalg.norm(pose[:3, :3] - target.rotation)) / (2.0 * math.sqrt(2.0))
        turn = 2.0 * math.asin(min(1.0, chord))
    return off, turn


def least_clearance(problem: "Problem", q: Floats, ends: Floats) -> tuple[float, int | None, str | None]:
    """Least clearance over sampled places of the body beyond the mount; where, and from which obstacle."""
    least, where, which = math.inf, None, None
    if len(problem.scene) == 0:
        return least, where, which
    places, segments = body_places(problem.robot, q, ends)
    radii = np.array(problem.robot.radii)[segments]
    for i, obstacle in enumerate(problem.scene.obstacles):
        clearances = measure(obstacle, places) - radii
        nearest = int(clearances.argmin()) if len(clearances) else 0
        if clearances.min(initial=math.inf) < least:
            least, where, which = float(clearances[nearest]), int(segments[nearest]) + 1, problem.scene.name(i)
    return least, where, which


def body_places(robot: "Robot", q: Floats, ends: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Sampled places (m, 3) of the backbone beyond the mount, and the segment (m,), 0 = first, that each is on."""
    places, segments = [], []
    before = 0.0
    for k, segment in enumerate(q):
        length = float(segment[2])
        free = before + np.linspace(0.0, length, SAMPLES + 1) >= robot.mount
        places.append((ends[k] @ arc_poses(segment, SAMPLES))[free, :3, 3])
        segments.append(np.full(len(places[-1]), k))
        before += length
    return np.concatenate(places), np.concatenate(segments)


def find_worst(problem: "Problem", q: Floats, overlap: bool) -> Worst:
    """The constraint that `q` (n, 3) is farthest from meeting, lengths relative to the robot's length.

    With `overlap` it is known to be the clearance, however deep.
    """
    robot, tolerance = problem.robot, problem.tolerance
    ends = segment_ends(robot, q)
    unit = robot.mean_length
    clearance, where, which = least_clearance(problem, q, ends)
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
