"""A wild world: one robot in one scene, and problems that each have a hidden solution there."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.kinematics import segment_ends, tip_poses
from benchmarks.judges.self_collision import Flags, surely_clear
from benchmarks.problems import direction_targets, random_configurations
from benchmarks.wild.obstacles import scene_about
from benchmarks.wild.robots import robot_with_shapes
from sinuous.base.checks import Floats

LIMIT = 1.0
"""Budget of one solve, in seconds, where a kind has none of its own."""

SHAPES = 48
"""Hidden solutions of one world, at most, one a problem."""

CLEAR = 1e-6
"""Least clearance of a hidden solution, of the robot's mean length."""

TOLERANCES = (-8.0, -2.0)
"""Powers of ten between which tolerances lie: of the robot's mean length, and rad."""

KINDS = {"position": 0.2, "direction": 0.3, "rotation": 0.4, "direction alone": 0.05, "rotation alone": 0.05}
"""What is asked of the tip, and how often."""

INTERMEDIATE = 0.15
"""Share of worlds that ask for the place of another segment's end as well."""

NEAR, TOGETHER = 0.35, 50
"""Most distance of a target of a thick arm from the base, of its mean length; and problems of one such world."""


@dataclass(frozen=True)
class World:
    """Problems in one scene.

    Attributes
    ----------
    robot : Robot
    scene : Scene
    tolerance : Tolerance
    targets : list of list of Target
        One list a problem: its targets are to be met at once.
    hidden : ndarray (m, n, 3)
        A solution of each, clear of obstacles and of itself.
    possible : bool
        Whether that is so: else the hidden shapes overlap something, and it is not known whether there is a solution.
    truth : Scene or None
        The obstacles that judges look at, where `scene` knows bounds of their distances only.
    time : float
        Budget of one solve, in seconds.
    loaded : bool
        Whether gravity bends the robot: its body is then the one at rest.
    """

    robot: sn.Robot
    scene: sn.Scene
    tolerance: sn.Tolerance
    targets: list[list[sn.Target]]
    hidden: Floats
    possible: bool = True
    truth: sn.Scene | None = None
    time: float = LIMIT
    loaded: bool = False


def make(seed: int, number: int) -> World:
    """Make world `number` of a seed."""
    rng = np.random.default_rng([seed, 9, number])
    while True:
        robot, q = robot_with_shapes(SHAPES, rng)
        if len(q) == 0:
            continue
        scene = scene_about(robot, q, rng)
        if len(scene):
            q = q[Clearances(robot, scene).least(q, 0.0) > CLEAR * robot.mean_length]
        if len(q):
            break
    position, angle = 10.0 ** rng.uniform(*TOLERANCES, 2)
    return World(robot, scene, sn.Tolerance(position * robot.mean_length, angle), asked(robot, q, rng), q)


def asked(robot: sn.Robot, q: Floats, rng: Generator, kind: str | None = None) -> list[list[sn.Target]]:
    """Return targets for every shape, all of one of the `KINDS`: by default any."""
    kind = str(rng.choice(list(KINDS), p=list(KINDS.values()))) if kind is None else kind
    segment = int(rng.integers(1, len(robot))) if len(robot) > 1 and rng.random() < INTERMEDIATE else 0
    questions = []
    for ends in segment_ends(robot, q):
        tip = ends[-1] @ robot.tool
        place = None if kind.endswith("alone") else tip[:3, 3]
        targets = [
            sn.Target(
                place,
                direction=tip[:3, 2] if kind.startswith("direction") else None,
                rotation=tip[:3, :3] if kind.startswith("rotation") else None,
            )
        ]
        if segment:
            targets.append(sn.Target(ends[segment][:3, 3], segment=segment))
        questions.append(targets)
    return questions


def thick_arm(n: int, seed: int, number: int) -> World:
    """Make problems for an arm as thick as a tenth of its segments, near its base: of shapes that are clear of it."""
    robot, rng = sn.Robot.uniform(n, (100, 120), max_bend=3.1, radius=10), np.random.default_rng([seed, 10, n, number])
    found = np.empty((0, n, 3))
    while len(found) < TOGETHER:
        drawn = random_configurations(robot, 4 * TOGETHER, rng)
        drawn = drawn[np.linalg.norm(tip_poses(robot, drawn)[:, :3, 3], axis=1) < NEAR * robot.mean_length]
        tight = (np.hypot(drawn[..., 0], drawn[..., 1]) > drawn[..., 2] / np.array(robot.radii)).any(axis=1)
        found = np.concatenate([found, drawn[surely_clear(robot, drawn) & ~tight]])
    q = found[:TOGETHER]
    targets = [[target] for target in direction_targets(robot, q)]
    return World(robot, sn.Scene(), sn.Tolerance().for_robot(robot), targets, q)


def standing(robot: sn.Robot, drives: Floats) -> Flags:
    """Whether the body of a robot under load is at rest at drives (m, n, 3), and stays there."""

    def stands(q: Floats) -> bool:
        try:
            return robot.shape(q).stable
        except sn.InputError:
            return False

    return np.array([stands(q) for q in drives], bool)
