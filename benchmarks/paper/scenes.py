"""The problems of the paper's experiments: its robot, its four poses, and paths on the far side of random spheres."""

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.problems import PAPER_POSES, ProblemSet, arm
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle

FREE_BEND = 6.0
"""The paper limits no bends, but its arcs end short of a full turn."""

PAPER_TOLERANCE = sn.Tolerance(1.0, 0.0175)
"""In mm and rad: the paper's for the orientation; 1 mm for the position, which the published answers are within."""

TOTAL = 480.0
"""Mean length of a robot that follows a path, mm, whatever the number of its segments."""

POINTS = 180
"""Waypoints of a path, as in the paper."""

HALF_WIDTH, LOWEST, HIGHEST = 0.45, 0.1, 0.7
"""Where spheres have their centers, of the robot's length: across its first axis, and along it."""

PATH_GAP, BASE_GAP, BASE_LENGTH = 0.03, 0.03, 0.12
"""What spheres leave free, of the robot's length: around the path, and around the first piece of the straight robot."""


def paper_pose(name: str, repeats: int) -> ProblemSet:
    """Return one of the paper's poses, so many times over."""
    position, direction = PAPER_POSES[name]
    return ProblemSet(
        arm(5, FREE_BEND), [sn.Target(position, direction=direction)] * repeats, sn.Scene(), PAPER_TOLERANCE
    )


def follower(segments: int) -> sn.Robot:
    """Return a robot whose lengths may change by a tenth, 1 mm thick, that stands upright."""
    length = TOTAL / segments
    return sn.Robot.uniform(segments, (0.9 * length, 1.1 * length), FREE_BEND, radius=1.0)


def far_path(points: int = POINTS) -> Floats:
    """Points (points, 3) of a closed figure of eight on the far side of the workspace."""
    turn = np.linspace(0.0, 2.0 * np.pi, points, endpoint=False)
    eight: Floats = TOTAL * np.stack(
        [0.3 * np.sin(turn), 0.22 * np.sin(2.0 * turn), 0.72 + 0.1 * np.cos(turn)], axis=-1
    )
    return eight


def path_through(segments: int, spheres: int, rng: Generator, points: int = POINTS) -> ProblemSet:
    """Return a path behind random spheres of random radii, 0.03 to 0.08 of the length; the tip's direction is free.

    Spheres leave free the path and the first piece of the robot, nothing else: whether a waypoint can be reached at all
    is not known.
    """
    path = far_path()
    base = np.linspace(0.0, BASE_LENGTH * TOTAL, 20)[:, None] * [0.0, 0.0, 1.0]
    found: list[Obstacle] = []
    while len(found) < spheres:
        across = rng.uniform(-HALF_WIDTH, HALF_WIDTH, 2)
        center = TOTAL * np.array([*across, rng.uniform(LOWEST, HIGHEST)])
        radius = TOTAL * rng.uniform(0.03, 0.08)
        gaps = [
            np.linalg.norm(line - center, axis=-1).min() - radius - gap * TOTAL
            for line, gap in ((path, PATH_GAP), (base, BASE_GAP))
        ]
        if min(gaps) > 0.0:
            found.append(sn.Sphere(center, radius))
    robot = follower(segments)
    targets = [sn.Target(point) for point in path[:: POINTS // points][:points]]
    return ProblemSet(robot, targets, sn.Scene(found), sn.Tolerance().for_robot(robot))
