"""A place: robot, scene and target of one problem, and the hidden shape that proves it possible."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple
from zlib import crc32

import numpy as np
from numpy.random import Generator

from benchmarks.judges.clearances import least_clearance
from benchmarks.judges.collisions import Body
from benchmarks.judges.judge import judge
from benchmarks.judges.kinematics import tip_poses
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.problem.target import Target
from sinuous.problem.tolerance import Tolerance
from sinuous.robot.robot import Robot
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene

PATIENCE = 300
"""Draws of one place before its family counts as having none."""

ROOM = 0.05
"""Clearance that every hidden shape has, of the body's radius: none is in just by rounding."""


@dataclass(frozen=True)
class Place:
    """One problem.

    Attributes
    ----------
    family : str
    seed : int
    robot : Robot
    scene : Scene
    target : Target
        Position of the hidden tip; for half of the seeds its direction too.
    tolerance : Tolerance
        With its position filled in.
    hidden_q : ndarray (n, 3)
        A configuration that is free, within limits, and at the target.
    """

    family: str
    seed: int
    robot: Robot
    scene: Scene
    target: Target
    tolerance: Tolerance
    hidden_q: Floats


class Sketch(NamedTuple):
    """What a family draws, not yet judged."""

    robot: Robot
    obstacles: Iterable[Obstacle]
    q: Floats


Draw = Callable[[int, Generator], Sketch | None]
"""From a seed and its random numbers to a sketch; `None` where the drawing came out impossible."""


def settle(family: str, seed: int, draw: Draw) -> Place:
    """Draw until the judge finds the hidden shape feasible.

    Raises
    ------
    RuntimeError
        When that never comes.
    """
    for attempt in range(PATIENCE):
        sketch = draw(seed, np.random.default_rng([crc32(family.encode()), seed, attempt]))
        if sketch is None:
            continue
        place = place_of(family, seed, sketch)
        if feasible(place) and proper(place.scene):
            return place
    raise RuntimeError(f"{family} has no place for seed {seed}")


def place_of(family: str, seed: int, sketch: Sketch) -> Place:
    """Ask for what the hidden shape reaches."""
    robot, q = sketch.robot, sketch.q
    tip = tip_poses(robot, q[None])[0]
    direction = tip[:3, 2] if (seed + seed // 20) % 2 else None
    target = Target(tip[:3, 3], direction=direction)
    return Place(family, seed, robot, Scene(sketch.obstacles), target, Tolerance().for_robot(robot), q)


def proper(scene: Scene) -> bool:
    """Whether no mesh cuts through itself, as a pipe can that bends back to its own wall."""
    try:
        scene.prepare()
    except InputError:
        return False
    return True


def feasible(place: Place) -> bool:
    """Whether the judge finds the hidden shape at the target, within limits, and free with room to spare."""
    robot, q = place.robot, place.hidden_q[None]
    room = ROOM * min(robot.radii)
    if least_clearance(robot, place.scene, q, room)[0] < room:
        return False
    return bool(judge(robot, [place.target], q, place.tolerance, Body(robot, place.scene)).right.all())
