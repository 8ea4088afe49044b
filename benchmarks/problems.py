"""Random problems from seeds, each of which the robot can reach, and those that the literature names."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges.clearances import overlaps
from benchmarks.judges.judge import Flags, right
from benchmarks.judges.kinematics import bend_caps, tip_poses
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle

DOWN = (0.0, 0.0, -1.0)

PATIENCE = 1000
"""Draws, of 20 configurations each, after which a scene counts as having no room."""


@dataclass(frozen=True)
class ProblemSet:
    """One robot in one scene, and targets that are to be met one at a time."""

    robot: sn.Robot
    targets: list[sn.Target]
    scene: sn.Scene
    tolerance: sn.Tolerance

    def within(self, relative: float) -> "ProblemSet":
        """Return the same problems, to be met to `relative` of the robot's mean length, and as many rad."""
        return replace(self, tolerance=sn.Tolerance(relative * self.robot.mean_length, relative))

    def only(self, numbers: Iterable[int]) -> "ProblemSet":
        """Return some of the problems."""
        return replace(self, targets=[self.targets[i] for i in numbers])

    def right(self, q: Floats) -> Flags:
        """Judge one configuration a problem."""
        return right(self.robot, self.targets, q, self.tolerance, self.scene)


def arm(count: int, max_bend: float, radius: float = 0.0) -> sn.Robot:
    """Return the paper's robot, hanging: segments of 45 to 70 mm."""
    return sn.Robot.uniform(count, (45, 70), max_bend, radius=radius, base=sn.pose(direction=DOWN))


def random_configurations(robot: sn.Robot, count: int, rng: Generator) -> Floats:
    """Draw configurations (count, n, 3) within limits: bends even over their discs, lengths over their ranges."""
    low, high = np.array([segment.length for segment in robot.segments]).T
    lengths = low + (high - low) * rng.random((count, len(robot)))
    norms = bend_caps(robot, lengths) * np.sqrt(rng.random((count, len(robot))))
    angles = 2.0 * math.pi * rng.random((count, len(robot)))
    return np.stack([norms * np.cos(angles), norms * np.sin(angles), lengths], axis=-1)


def target_at(tip: Floats, kind: str = "direction") -> sn.Target:
    """Return the target that a pose (4, 4) of the tip meets.

    Of its `position`, with its `direction` or its whole `rotation`; or, where the kind ends with `alone`, of these.
    """
    direction = tip[:3, 2] if kind.startswith("direction") else None
    rotation = tip[:3, :3] if kind.startswith("rotation") else None
    return sn.Target(None if kind.endswith("alone") else tip[:3, 3], direction=direction, rotation=rotation)


def tip_targets(robot: sn.Robot, q: Floats, kind: str = "direction") -> list[sn.Target]:
    """Return the targets that the tips of configurations meet, see `target_at`."""
    return [target_at(tip, kind) for tip in tip_poses(robot, q)]


def reachable(robot: sn.Robot, count: int, rng: Generator) -> ProblemSet:
    """Random positions and directions without obstacles, at the default tolerance."""
    targets = tip_targets(robot, random_configurations(robot, count, rng))
    return ProblemSet(robot, targets, sn.Scene(), sn.Tolerance().for_robot(robot))


def among_spheres(robot: sn.Robot, spheres: int, count: int, rng: Generator, asked: str = "direction") -> ProblemSet:
    """Return targets of collision-free configurations among spheres.

    Radii are 0.03 to 0.08 of the robot's mean length, centers even over the ball of 0.8 of it about the base; a ball
    of 0.15 of it about the base stays free.
    """
    unit = robot.mean_length
    found: list[Obstacle] = []
    while len(found) < spheres:
        center, radius = 0.8 * unit * in_ball(rng), unit * rng.uniform(0.03, 0.08)
        if np.linalg.norm(center) > radius + 0.15 * unit:
            found.append(sn.Sphere(robot.base[:3, 3] + center, radius))
    scene = sn.Scene(found)
    q = free_configurations(robot, scene, count, rng)
    return ProblemSet(robot, tip_targets(robot, q, asked), scene, sn.Tolerance().for_robot(robot))


def free_configurations(robot: sn.Robot, scene: sn.Scene, count: int, rng: Generator) -> Floats:
    """Draw configurations (count, n, 3) that the judge finds free."""
    found: list[Floats] = []
    for _ in range(PATIENCE):
        drawn = random_configurations(robot, 20, rng)
        found += list(drawn[~overlaps(robot, scene, drawn)])
        if len(found) >= count:
            return np.array(found[:count])
    raise RuntimeError("the scene leaves no room")


def in_ball(rng: Generator) -> Floats:
    """Draw a point of the unit ball, evenly."""
    point: Floats = direction(rng) * rng.random() ** (1.0 / 3.0)
    return point


def direction(rng: Generator) -> Floats:
    """Draw a unit vector, evenly."""
    drawn = rng.normal(size=3)
    return np.asarray(drawn / np.linalg.norm(drawn))


PAPER_POSES = {
    "A": ((-60, 150, -230), (-0.7071, 0, -0.7071)),
    "B": ((-10, 40, -260), (0, 0.2169, -0.9762)),
    "C": ((150, -90, -220), (0.5661, 0.2665, -0.7926)),
    "D": ((40, -60, -180), (0, 0, 1)),
}
"""Position (mm) and tip direction of the four targets of the paper."""


def paper_poses() -> ProblemSet:
    """Return the paper's four targets (P1), each to 1e-6 mm and 1e-6 rad."""
    targets = [sn.Target(position, direction=direction) for position, direction in PAPER_POSES.values()]
    return ProblemSet(arm(5, 2.4), targets, sn.Scene(), sn.Tolerance(1e-6, 1e-6))


FREE_BEND = 6.0
"""The paper limits no bends, but its arcs end short of a full turn."""

PAPER_TOLERANCE = sn.Tolerance(1.0, 0.0175)
"""In mm and rad: the paper's for the orientation; 1 mm for the position, which the published answers are within."""

PATH_LENGTH = 480.0
"""Mean length of a robot that follows a path, mm, whatever the number of its segments."""

WAYPOINTS = 180
"""Points of a path, as in the paper."""

HALF_WIDTH, LOWEST, HIGHEST = 0.45, 0.1, 0.7
"""Where spheres have their centers, of the robot's length: across its first axis, and along it."""

PATH_GAP, BASE_GAP, BASE_LENGTH = 0.03, 0.03, 0.12
"""What spheres leave free, of the robot's length: around the path, and around the first piece of the straight robot."""


def path_through(segments: int, spheres: int, rng: Generator, points: int = WAYPOINTS) -> ProblemSet:
    """Return a closed figure of eight behind random spheres of 0.03 to 0.08 of the length; the direction is free.

    The robot stands upright, 1 mm thick, with lengths within a tenth. Spheres leave free the path and the first piece
    of the robot, nothing else: whether a waypoint can be reached at all is not known.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, WAYPOINTS, endpoint=False)
    eight = [0.3 * np.sin(turn), 0.22 * np.sin(2.0 * turn), 0.72 + 0.1 * np.cos(turn)]
    path = PATH_LENGTH * np.stack(eight, axis=-1)
    base = np.linspace(0.0, BASE_LENGTH * PATH_LENGTH, 20)[:, None] * [0.0, 0.0, 1.0]
    found: list[Obstacle] = []
    while len(found) < spheres:
        across = rng.uniform(-HALF_WIDTH, HALF_WIDTH, 2)
        center = PATH_LENGTH * np.array([*across, rng.uniform(LOWEST, HIGHEST)])
        radius = PATH_LENGTH * rng.uniform(0.03, 0.08)
        gaps = [
            np.linalg.norm(line - center, axis=-1).min() - radius - gap * PATH_LENGTH
            for line, gap in ((path, PATH_GAP), (base, BASE_GAP))
        ]
        if min(gaps) > 0.0:
            found.append(sn.Sphere(center, radius))
    length = PATH_LENGTH / segments
    robot = sn.Robot.uniform(segments, (0.9 * length, 1.1 * length), FREE_BEND, radius=1.0)
    targets = [sn.Target(point) for point in path[:: WAYPOINTS // points][:points]]
    return ProblemSet(robot, targets, sn.Scene(found), sn.Tolerance().for_robot(robot))


def published_configurations(robot: sn.Robot, count: int, rng: Generator) -> Floats:
    """Draw configurations (count, n, 3) as published codes do: bends pi U(0, 1), plane angles 2 pi U(0, 1)."""
    bends, angles = math.pi * rng.random((count, len(robot))), 2.0 * math.pi * rng.random((count, len(robot)))
    low, high = np.array([segment.length for segment in robot.segments]).T
    lengths = low + (high - low) * rng.random((count, len(robot)))
    return np.stack([bends * np.cos(angles), bends * np.sin(angles), lengths], axis=-1)


def full_poses(seed: int, count: int) -> ProblemSet:
    """Full poses of three inextensible segments of length 1 (P2).

    Position and angle are each to be met to 0.7e-6, so that the norm of the error in se(3) is below 1e-6.
    """
    robot = sn.Robot.uniform(3, 1.0, math.pi)
    q = published_configurations(robot, count, np.random.default_rng(seed))
    return ProblemSet(robot, tip_targets(robot, q, "rotation"), sn.Scene(), sn.Tolerance(0.7e-6, 0.7e-6))
