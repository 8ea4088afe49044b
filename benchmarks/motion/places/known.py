"""Plans for which a motion is known: from the straight robot into places that were made around a hidden motion."""

from collections.abc import Callable, Iterator
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
from benchmarks.motion.places.motions import LEADING, WANDERING, draw_motion
from benchmarks.motion.places.trials import COUNT, QUICK, SECONDS, STRIDE, Trial, lines_of
from benchmarks.places.parts.robots import robot_of
from benchmarks.solvers.parallel import in_processes
from sinuous.checks import Floats
from sinuous.robot.robot import Robot
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene

PLANNED = "plans for which a motion is known: planned and proved within 5 s, and found clear by the judges"
FALSE = "plans for which a motion is known: called proved, and a judge finds a collision"

PATIENCE = 300
"""Draws of one place before its family counts as having none."""

Around = Callable[[Robot, Floats, Generator], list[Obstacle] | None]
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


def _balls(count: int, robot: Robot, knots: Floats, rng: Generator) -> list[Obstacle] | None:
    found = balls(robot, knots, count, rng)
    return None if found is None else list(found)


def _plates(robot: Robot, knots: Floats, rng: Generator) -> list[Obstacle] | None:
    return list(plates(robot, knots, rng))


FAMILIES: dict[str, tuple[str, Around]] = {
    f"{what}, {kind}": (kind, around)
    for what, around in (("40 balls", partial(_balls, 40)), ("100 balls", partial(_balls, 100)), ("plates", _plates))
    for kind in (WANDERING, LEADING)
}
"""How the hidden motion goes, and what stands around it."""


def make(family: str, seed: int) -> Hidden:
    """Make the place of a seed.

    Raises
    ------
    RuntimeError
        When none is found.
    """
    kind, around = FAMILIES[family]
    for attempt in range(PATIENCE):
        rng = np.random.default_rng([crc32(family.encode()), seed, attempt])
        robot = robot_of(seed, rng)
        knots = draw_motion(robot, kind, rng)
        obstacles = None if knots is None else around(robot, knots, rng)
        if knots is None or obstacles is None:
            continue
        scene = Scene(obstacles)
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
