"""Plans for which a motion is known: from the straight robot into places that were made around a hidden motion."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple
from zlib import crc32

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness.lines import Line
from benchmarks.harness.plan import Plan
from benchmarks.motion.judged import collides
from benchmarks.motion.places.around import balls, plates
from benchmarks.motion.places.motions import KINDS, THREADING, draw_motion, keeps_apart
from benchmarks.motion.places.trials import COUNT, QUICK, SECONDS, STRIDE, Trial, lines_of
from benchmarks.motion.places.walls import door_in, door_out, pipe, two_doors
from benchmarks.places.meshed import one_mesh
from benchmarks.places.parts.robots import longest, robot_of
from benchmarks.solvers.parallel import in_processes
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Box, Obstacle
from sinuous.scene.scene import Scene

PLANNED = "plans for which a motion is known: planned and proved within 5 s, and found clear by the judges"
FALSE = "plans for which a motion is known: called proved, and a judge finds a collision"

PATIENCE = 300
"""Draws of one place before its family counts as having none."""

Around = Callable[[Robot, Floats, Generator], Sequence[Obstacle] | None]
"""From a robot and the knots of a motion (T, n, 3) to what stands around it; `None` where there is no room."""


class Hidden(NamedTuple):
    """A robot among obstacles, and a motion (T, n, 3) that the judges find clear."""

    robot: Robot
    scene: Scene
    knots: Floats


class Task(NamedTuple):
    """A place, by its name."""

    family: str
    seed: int


class Family(NamedTuple):
    """Places of one kind.

    Attributes
    ----------
    kind : str
        How the hidden motion goes.
    around : callable
        What stands around it.
    robots : callable
        From a seed and its random numbers to a robot.
    """

    kind: str
    around: Around
    robots: Callable[[int, Generator], Robot] = robot_of


def _meshed(walls: Callable[[Robot, Floats, Generator], list[Box] | None]) -> Around:
    """The same walls as one mesh."""

    def around(robot: Robot, knots: Floats, rng: Generator) -> list[Obstacle] | None:
        boxes = walls(robot, knots, rng)
        return None if boxes is None else [one_mesh(boxes, robot)]

    return around


_DOORS: dict[str, Callable[[Robot, Floats, Generator], list[Box] | None]] = {
    "door in": door_in,
    "door out": door_out,
    "two doors": two_doors,
}

_ANY: dict[str, Around] = {
    "40 balls": partial(balls, count=40),
    "100 balls": partial(balls, count=100),
    "plates": plates,
}

FAMILIES: dict[str, Family] = {
    **{f"{what}, {kind}": Family(kind, around) for what, around in _ANY.items() for kind in KINDS},
    **{what: Family(THREADING, around) for what, around in _DOORS.items()},
    **{f"{what} mesh": Family(THREADING, _meshed(around)) for what, around in _DOORS.items()},
    "pipe between": Family(THREADING, pipe),
    "folded": Family(THREADING, door_out, longest),
    "folded mesh": Family(THREADING, _meshed(door_out), longest),
}
"""How the hidden motion goes, and what stands around it."""


def make(family: str, seed: int) -> Hidden:
    """Make the place of a seed.

    Raises
    ------
    RuntimeError
        When none is found.
    """
    kind, around, robots = FAMILIES[family]
    for attempt in range(PATIENCE):
        rng = np.random.default_rng([crc32(family.encode()), seed, attempt])
        robot = robots(seed, rng)
        knots = draw_motion(robot, kind, rng)
        obstacles = around(robot, knots, rng)
        if obstacles is None or not keeps_apart(robot, knots):
            continue
        scene = Scene(list(obstacles))
        if not collides(robot, scene, knots):
            return Hidden(robot, scene, knots)
    raise RuntimeError(f"{family} has no place for seed {seed}")


def examine(task: Task) -> Trial:
    """Plan from where a hidden motion begins to where it ends, and judge the plan."""
    place = make(*task)
    motion = sn.plan(place.robot, place.knots[0], place.knots[-1], place.scene, time=SECONDS)
    wrong = collides(place.robot, place.scene, motion.q) if motion.solved else ""
    return Trial(motion.seconds, True, str(motion.status), wrong)


def measure(plan: Plan, family: str) -> Iterator[Line]:
    """Plan into places of one family."""
    tasks = [Task(family, 1000 * plan.seed + STRIDE * i) for i in range(plan.count(COUNT, QUICK))]
    trials = list(plan.track(in_processes(examine, tasks, alone=plan.quick), family, len(tasks)))
    yield from lines_of(family, trials, PLANNED, FALSE)


PARTS = {f"known {family}": partial(measure, family=family) for family in FAMILIES}
"""Pieces of the experiment, by name."""
