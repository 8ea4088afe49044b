"""Anything that can be built, among obstacles of all kinds."""

from typing import Any

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges.collisions import Body
from benchmarks.judges.kinematics import tip_poses
from benchmarks.problems.sets import ProblemSet, in_ball, random_configurations
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.obstacles import Box, Capsule, Cylinder, HalfSpace, Obstacle, Sphere
from sinuous.scene.scene import Scene


def clutter(seed: int, count: int) -> ProblemSet:
    """Return anything that can be built: 3 to 6 segments of all sorts among obstacles of all kinds, half in a room.

    Half of the targets are those of collision-free configurations, as far as such are found; the others come from
    configurations that overlap something, and are often impossible.
    """
    rng = np.random.default_rng(seed)
    robot = _random_robot(rng)
    unit, base = robot.mean_length, robot.base[:3, 3]
    obstacles = [_random_obstacle(robot, rng) for _ in range(rng.integers(2, 25))]
    if rng.random() < 0.5:
        room = unit * rng.uniform(0.9, 2.0, 3)
        obstacles.append(Box(base + 0.1 * unit * in_ball(rng), room, _rotation(rng), inside=True))
    scene = Scene(obstacles)
    drawn = random_configurations(robot, 2 * count, rng)
    hit = np.array(Body(robot, scene).overlaps(drawn))
    free = drawn[~hit]
    q = np.concatenate([free[: count // 2], drawn[hit], free[count // 2 :]])[:count]
    targets = [_random_target(tip, rng) for tip in tip_poses(robot, q)]
    return ProblemSet(robot, targets, scene, Tolerance().for_robot(robot))


def _random_target(tip: Floats, rng: Generator) -> Target:
    """Ask for the position of a tip, and for nothing more, its direction, or its rotation."""
    asked: dict[str, Any] = rng.choice(np.array([{}, {"direction": tip[:3, 2]}, {"rotation": tip[:3, :3]}]))
    return Target(tip[:3, 3], **asked)


def _random_robot(rng: Generator) -> Robot:
    """Return a robot somewhere, of equal segments or of different ones, perhaps with a mount or a tool."""
    count, length = int(rng.integers(3, 7)), rng.uniform(0.05, 0.3)
    alike = rng.random() < 0.5
    segments = [_random_segment(length, rng)] * count if alike else [_random_segment(length, rng) for _ in range(count)]
    mount = rng.uniform(0.0, 0.5) * length if rng.random() < 0.2 else 0.0
    tool = sn.pose(0.3 * length * in_ball(rng), rotation=_rotation(rng)) if rng.random() < 0.2 else None
    return Robot(segments, mount=mount, base=sn.pose(rng.normal(size=3), rotation=_rotation(rng)), tool=tool)


def _random_segment(length: float, rng: Generator) -> Segment:
    """Return a segment about as long as `length`; some cannot stretch, some cannot bend, some can vanish."""
    own = length * rng.uniform(0.7, 1.3)
    low = rng.choice([own, own / 1.4, 0.0], p=[0.3, 0.6, 0.1])
    max_bend = rng.choice([rng.uniform(1.0, 3.0), 0.0], p=[0.9, 0.1])
    max_curvature = rng.uniform(2.0, 4.0) / own if rng.random() < 0.3 else None
    return Segment((low, own), max_bend, max_curvature, radius=length * rng.uniform(0.015, 0.15))


def _random_obstacle(robot: Robot, rng: Generator) -> Obstacle:
    """Return one of the five kinds, clear of a ball about the base."""
    unit, base = robot.mean_length, robot.base[:3, 3]
    while True:
        obstacle = _draw_obstacle(unit, base, rng)
        if Scene([obstacle]).distance(base) > max(robot.radii) + 0.05 * unit:
            return obstacle


def _draw_obstacle(unit: float, base: Floats, rng: Generator) -> Obstacle:
    center, other = base + unit * in_ball(rng), base + unit * in_ball(rng)
    radius = unit * rng.uniform(0.02, 0.12)
    kind = rng.choice(["sphere", "box", "capsule", "cylinder", "half_space"], p=[0.3, 0.25, 0.2, 0.2, 0.05])
    if kind == "sphere":
        return Sphere(center, radius)
    if kind == "box":
        return Box(center, unit * rng.uniform(0.04, 0.4, 3), _rotation(rng))
    if kind == "capsule":
        return Capsule(center, other, 0.5 * radius)
    if kind == "cylinder":
        return Cylinder(center, other, 0.5 * radius)
    normal = in_ball(rng)
    return HalfSpace(base - unit * rng.uniform(0.1, 0.8) * normal / np.linalg.norm(normal), normal)


def _rotation(rng: Generator) -> Floats:
    """Draw a unit quaternion, evenly."""
    quaternion: Floats = rng.normal(size=4)
    return quaternion
