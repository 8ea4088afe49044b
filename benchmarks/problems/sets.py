"""Problems that can be met one at a time: random ones from seeds; every target is one that the robot can reach."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from benchmarks.judges.collisions import Body
from benchmarks.judges.kinematics import bend_caps, tip_poses
from sinuous.base.checks import Floats
from sinuous.model.poses import pose
from sinuous.model.robot import Robot
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.obstacles import Obstacle, Sphere
from sinuous.scene.scene import Scene

DOWN = (0.0, 0.0, -1.0)

PATIENCE = 1000
"""Draws, of 20 configurations each, after which a scene counts as having no room."""


@dataclass(frozen=True)
class ProblemSet:
    """One robot in one scene, and targets that are to be met one at a time."""

    robot: Robot
    targets: list[Target]
    scene: Scene
    tolerance: Tolerance

    def with_tolerance(self, tolerance: Tolerance) -> "ProblemSet":
        """Return the same problems, to be met more or less exactly."""
        return ProblemSet(self.robot, self.targets, self.scene, tolerance)

    def only(self, numbers: Iterable[int]) -> "ProblemSet":
        """Return some of the problems."""
        return ProblemSet(self.robot, [self.targets[i] for i in numbers], self.scene, self.tolerance)


def relative_tolerance(robot: Robot, relative: float) -> Tolerance:
    """Allow `relative` of the robot's mean length, and as many rad."""
    return Tolerance(relative * robot.mean_length, relative)


def arm(count: int, max_bend: float, radius: float = 0.0) -> Robot:
    """Return the paper's robot, hanging: segments of 45 to 70 mm."""
    return Robot.uniform(count, (45, 70), max_bend, radius=radius, base=pose(direction=DOWN))


def random_configurations(robot: Robot, count: int, rng: Generator) -> Floats:
    """Draw configurations (count, n, 3) within limits: bends even over their discs, lengths over their ranges."""
    low, high = np.array([segment.length for segment in robot.segments]).T
    lengths = low + (high - low) * rng.random((count, len(robot)))
    norms = bend_caps(robot, lengths) * np.sqrt(rng.random((count, len(robot))))
    angles = 2.0 * math.pi * rng.random((count, len(robot)))
    return np.stack([norms * np.cos(angles), norms * np.sin(angles), lengths], axis=-1)


def direction_targets(robot: Robot, q: Floats) -> list[Target]:
    """Return where the tips of configurations are and point to."""
    return [Target(tip[:3, 3], direction=tip[:3, 2]) for tip in tip_poses(robot, q)]


def reachable(robot: Robot, count: int, rng: Generator) -> ProblemSet:
    """Random positions and directions without obstacles, at the default tolerance."""
    targets = direction_targets(robot, random_configurations(robot, count, rng))
    return ProblemSet(robot, targets, Scene(), Tolerance().for_robot(robot))


def among_spheres(robot: Robot, spheres: int, count: int, rng: Generator) -> ProblemSet:
    """Return targets of collision-free configurations among spheres.

    Radii are 0.03 to 0.08 of the robot's mean length, centers even over the ball of 0.8 of it about the base; a ball
    of 0.15 of it about the base stays free.
    """
    unit = robot.mean_length
    found: list[Obstacle] = []
    while len(found) < spheres:
        center, radius = 0.8 * unit * in_ball(rng), unit * rng.uniform(0.03, 0.08)
        if np.linalg.norm(center) > radius + 0.15 * unit:
            found.append(Sphere(robot.base[:3, 3] + center, radius))
    scene = Scene(found)
    q = free_configurations(robot, scene, count, rng)
    return ProblemSet(robot, direction_targets(robot, q), scene, Tolerance().for_robot(robot))


def free_configurations(robot: Robot, scene: Scene, count: int, rng: Generator) -> Floats:
    """Draw configurations (count, n, 3) that the judge finds free."""
    body = Body(robot, scene)
    found: list[Floats] = []
    for _ in range(PATIENCE):
        drawn = random_configurations(robot, 20, rng)
        found += [q for q, hit in zip(drawn, body.overlaps(drawn), strict=True) if not hit]
        if len(found) >= count:
            return np.array(found[:count])
    raise RuntimeError("the scene leaves no room")


def in_ball(rng: Generator) -> Floats:
    """Draw a point of the unit ball, evenly."""
    direction = rng.normal(size=3)
    point: Floats = direction / np.linalg.norm(direction) * rng.random() ** (1.0 / 3.0)
    return point
