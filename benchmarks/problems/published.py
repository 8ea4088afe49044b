"""Problems that the literature names."""

import math

import numpy as np

from benchmarks.judges.kinematics import tip_poses
from benchmarks.problems.sets import ProblemSet, arm
from sinuous.model.robot import Robot
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.scene import Scene

PAPER_POSES = {
    "A": ((-60, 150, -230), (-0.7071, 0, -0.7071)),
    "B": ((-10, 40, -260), (0, 0.2169, -0.9762)),
    "C": ((150, -90, -220), (0.5661, 0.2665, -0.7926)),
    "D": ((40, -60, -180), (0, 0, 1)),
}
"""Position (mm) and tip direction of the four targets of the paper."""


def paper_poses() -> ProblemSet:
    """Return the paper's four targets (P1), each to 1e-6 mm and 1e-6 rad."""
    targets = [Target(position, direction=direction) for position, direction in PAPER_POSES.values()]
    return ProblemSet(arm(5, 2.4), targets, Scene(), Tolerance(1e-6, 1e-6))


def full_poses(seed: int, count: int) -> ProblemSet:
    """Full poses of three inextensible segments of length 1 (P2): bends pi U(0, 1), plane angles 2 pi U(0, 1).

    Position and angle are each to be met to 0.7e-6, so that the norm of the error in se(3) is below 1e-6.
    """
    rng = np.random.default_rng(seed)
    bends = math.pi * rng.random((count, 3))
    angles = 2.0 * math.pi * rng.random((count, 3))
    q = np.stack([bends * np.cos(angles), bends * np.sin(angles), np.ones((count, 3))], axis=-1)
    robot = Robot.uniform(3, 1.0, math.pi)
    targets = [Target(tip[:3, 3], rotation=tip[:3, :3]) for tip in tip_poses(robot, q)]
    return ProblemSet(robot, targets, Scene(), Tolerance(0.7e-6, 0.7e-6))
