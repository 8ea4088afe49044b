"""Does `solve_all` find every solution? Three segments of fixed length to full poses, against a dense scan."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from benchmarks.harness.lines import Goal, Line
from benchmarks.judges.judge import judge
from benchmarks.judges.kinematics import body_points
from benchmarks.problems import full_poses
from benchmarks.wild.scan import all_solutions
from sinuous.base.checks import Floats
from sinuous.model.poses import pose
from sinuous.model.robot import Robot
from sinuous.problem.target import Target, Tolerance
from sinuous.solver.solver import Solver

APART = 0.02
"""Distance between backbones from which solutions are distinct, of the robot's mean length: that of `solve_all`."""

ASKED = 64
"""Solutions that `solve_all` may return: more than there are."""

TOLERANCE = Tolerance(1e-9, 1e-9)

POSES = 200

SECTION = "solve_all against a dense scan: three segments of length 1, full poses"


class Compared(NamedTuple):
    """What came of one pose.

    Attributes
    ----------
    scanned, found : int
        Branches that the scan found, and how many of these `solve_all` found, too.
    more : int
        Solutions of `solve_all` that the scan did not find.
    false : int
        Solutions of `solve_all` that do not meet the pose, or exceed a limit.
    seconds : float
        Until the last of them was found.
    """

    scanned: int
    found: int
    more: int
    false: int
    seconds: float


def arm(max_bend: float) -> Robot:
    """Return the robot of these poses."""
    return Robot.uniform(3, 1.0, max_bend)


def line_poses() -> list[Target]:
    """Return the 30 poses along a line (P7)."""
    turned = pose(rotation=[math.cos(math.pi / 6), math.sin(math.pi / 6), 0.0, 0.0])[:3, :3]
    return [Target((-0.5 + i / 29, -0.2, 2.7), rotation=turned) for i in range(30)]


def random_poses(seed: int, count: int) -> list[Target]:
    """Return poses of random bends to pi (P2)."""
    return full_poses(seed, count).targets


def compare(target: Target, max_bend: float) -> Compared:
    """Hold `solve_all` against the scan for one pose, with bends up to `max_bend`."""
    robot = arm(max_bend)
    apart = APART * robot.mean_length
    tip = np.eye(4)
    tip[:3, :3], tip[:3, 3] = target.rotation, target.position
    scanned = np.array(all_solutions(robot, tip, apart)).reshape(-1, 3, 3)
    solutions = Solver(robot, tolerance=TOLERANCE).solve_all(target, count=ASKED, apart=APART)
    q = np.array([solution.q for solution in solutions]).reshape(-1, 3, 3)
    right = judge(robot, [target] * len(q), q, TOLERANCE).right
    found = sum(_among(robot, one, q, apart) for one in scanned)
    more = sum(not _among(robot, one, scanned, apart) for one in q)
    seconds = max((solution._outcome.seconds for solution in solutions), default=0.0)
    return Compared(len(scanned), found, more, int((~right).sum()), seconds)


def _among(robot: Robot, one: Floats, q: Floats, apart: float) -> bool:
    """Whether a configuration (3, 3) is the same solution as one of (m, 3, 3)."""
    if len(q) == 0:
        return False
    points, others = (body_points(robot, each, 8)[0].reshape(len(each), -1, 3) for each in (one[None], q))
    return bool((np.linalg.norm(points - others, axis=-1).max(axis=1) <= apart).any())


def lines_of(name: str, compared: list[Compared]) -> Iterator[Line]:
    """Sum up poses of one kind."""
    scanned, found = (sum(getattr(each, key) for each in compared) for key in ("scanned", "found"))
    lacking = [f"{i}: {each.found} of {each.scanned}" for i, each in enumerate(compared) if each.found < each.scanned]
    goal = Goal(100.0, at_most=False)
    share = 100.0 * found / scanned if scanned else math.nan
    note = f"lacking at pose {', '.join(lacking)}" if lacking else ""
    yield Line(SECTION, f"{name}: branches found", share, "%", goal, None, (found, scanned), note)
    yield Line(SECTION, f"{name}: last one found after", max(each.seconds for each in compared), "ms", noise=1.0)
    more = sum(each.more for each in compared)
    yield Line(SECTION, f"{name}: found beyond those of the scan", more, "")
    yield Line(SECTION, f"{name}: false", sum(each.false for each in compared), "", Goal(0, correctness=True))
