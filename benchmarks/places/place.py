"""A place: robot, scene and target of one problem, and the hidden shape that proves it possible."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple
from zlib import crc32

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges import judge, self_collision
from benchmarks.judges.clearances import GRACE, overlaps, prepared
from benchmarks.judges.kinematics import segment_ends, tip_poses
from benchmarks.problems import target_at
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle

PATIENCE = 3000
"""Draws of one place before its family counts as having none."""

JOINTED, INTERMEDIATE = 5, 0.2
"""Fewest segments of robots that are asked for an intermediate target, and the share of these that are."""

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
    targets : tuple of Target
        The last is the position of the hidden tip; for half of the seeds its direction too. Before it there may be the
        position of the end of a segment further back.
    tolerance : Tolerance
        With its position filled in.
    hidden_q : ndarray (n, 3)
        A configuration that is free, within limits, and at the target.
    """

    family: str
    seed: int
    robot: sn.Robot
    scene: sn.Scene
    targets: tuple[sn.Target, ...]
    tolerance: sn.Tolerance
    hidden_q: Floats

    @property
    def target(self) -> sn.Target:
        """The target of the tip."""
        return self.targets[-1]


class Sketch(NamedTuple):
    """What a family draws, not yet judged."""

    robot: sn.Robot
    obstacles: Iterable[Obstacle]
    q: Floats
    intermediate: int | None = None
    """Segment whose end is asked for too."""


def sketch_of(robot: sn.Robot, obstacles: Iterable[Obstacle], q: Floats, rng: Generator) -> Sketch:
    """Return a sketch; of robots with enough segments, some are asked for an intermediate target too."""
    asked = len(robot) >= JOINTED and rng.random() < INTERMEDIATE
    return Sketch(robot, obstacles, q, int(rng.integers(len(robot) // 2, len(robot) - 1)) if asked else None)


Draw = Callable[[int, Generator], Sketch | None]
"""From a seed and its random numbers to a sketch; `None` where the drawing came out impossible."""


Trap = Callable[[sn.Robot, Generator], Sketch | None]
"""The same for a robot that is given."""


def trapped(trap: Trap, robots: Callable[[int, Generator], sn.Robot], seed: int, rng: Generator) -> Sketch | None:
    """Draw a trap for the robot of a seed."""
    return trap(robots(seed, rng), rng)


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
    targets = [target_at(tip, "direction" if (seed + seed // 20) % 2 else "position")]
    if sketch.intermediate is not None:
        targets.insert(
            0, sn.Target(segment_ends(robot, q[None])[0, sketch.intermediate, :3, 3], segment=sketch.intermediate)
        )
    return Place(family, seed, robot, sn.Scene(sketch.obstacles), tuple(targets), sn.Tolerance().for_robot(robot), q)


def proper(scene: sn.Scene) -> bool:
    """Whether no mesh cuts through itself, as a pipe can that bends back to its own wall."""
    try:
        scene.prepare()
    except sn.InputError:
        return False
    return True


def feasible(place: Place) -> bool:
    """Whether the judge finds the hidden shape at the targets, within limits, and free with room to spare."""
    robot, q = place.robot, place.hidden_q[None]
    room = 0.0 if robot.joints else ROOM * min(robot.radii)
    if prepared(robot, place.scene).least(q, room)[0] < room or self_collision.look(robot, q, room).least[0] < room:
        return False
    return _at_targets(place, q[0])


def right(place: Place, q: Floats) -> bool:
    """Whether the judges find a configuration (n, 3) right for all targets of a place, and clear of all obstacles.

    Where there are joints, the body has to be clear of itself, too: links are judged nowhere else.
    """
    robot = place.robot
    if not _at_targets(place, q) or overlaps(robot, place.scene, q[None])[0]:
        return False
    return not robot.joints or self_collision.look(robot, q[None], 0.0).least[0] >= -GRACE * robot.mean_length


def _at_targets(place: Place, q: Floats) -> bool:
    """Whether a configuration (n, 3) is at all targets, and within limits."""
    count = len(place.targets)
    return bool(judge.right(place.robot, place.targets, np.repeat(q[None], count, axis=0), place.tolerance).all())
