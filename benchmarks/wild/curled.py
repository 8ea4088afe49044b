"""Thick arms and targets near their base: where bodies run through themselves unless that is prevented."""

import numpy as np

from benchmarks.judges.kinematics import tip_poses
from benchmarks.judges.self_collision import surely_clear
from benchmarks.problems.sets import direction_targets, random_configurations
from benchmarks.wild.worlds import World
from sinuous.model.robot import Robot
from sinuous.problem.target import Tolerance
from sinuous.scene.scene import Scene

NEAR = 0.35
"""Most distance of a target from the base, of the robot's mean length."""

TOGETHER = 50
"""Problems of one world."""


def arm(n: int) -> Robot:
    """Return a thick arm: radius 10, segments of 100 to 120 that bend by up to 3.1 rad."""
    return Robot.uniform(n, (100, 120), max_bend=3.1, radius=10)


def make(n: int, seed: int, number: int) -> World:
    """Make `TOGETHER` problems of `n` segments: position and direction of shapes that are clear of themselves."""
    robot, rng = arm(n), np.random.default_rng([seed, 10, n, number])
    found = np.empty((0, n, 3))
    while len(found) < TOGETHER:
        drawn = random_configurations(robot, 4 * TOGETHER, rng)
        drawn = drawn[np.linalg.norm(tip_poses(robot, drawn)[:, :3, 3], axis=1) < NEAR * robot.mean_length]
        tight = (np.hypot(drawn[..., 0], drawn[..., 1]) > drawn[..., 2] / np.array(robot.radii)).any(axis=1)
        found = np.concatenate([found, drawn[surely_clear(robot, drawn) & ~tight]])
    q = found[:TOGETHER]
    targets = [[target] for target in direction_targets(robot, q)]
    return World(robot, Scene(), Tolerance().for_robot(robot), targets, q)
