"""Plans for which a motion is known: from the straight robot into places that were made around a hidden motion."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple
from zlib import crc32

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness.experiment import Plan
from benchmarks.harness.lines import Goal, Line, Times
from benchmarks.harness.parallel import in_processes
from benchmarks.judges.motions import wrong_in
from benchmarks.motion.around import balls, door_in, door_out, pipe, plates, two_doors
from benchmarks.motion.hidden import KINDS, THREADING, draw_motion, keeps_apart
from benchmarks.places.parts.robots import longest, robot_of
from benchmarks.places.scans import one_mesh
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle

PLANNED = "plans for which a motion is known: planned and proved within 5 s, and found clear by the judges"
FALSE = "plans for which a motion is known: called proved, and a judge finds a collision"

COUNT, QUICK = 8, 1
"""Places of a family."""

STRIDE = 7
"""From one place's seed to the next: eight places have robots of all sizes, with stages and without."""

SECONDS = 5.0

PATIENCE = 300
"""Draws of one place before its family counts as having none."""

Around = Callable[[sn.Robot, Floats, Generator], Sequence[Obstacle] | None]
"""From a robot and the knots of a motion (T, n, 3) to what stands around it; `None` where there is no room."""


class Hidden(NamedTuple):
    """A robot among obstacles, and a motion (T, n, 3) that the judges find clear."""

    robot: sn.Robot
    scene: sn.Scene
    knots: Floats


class Trial(NamedTuple):
    """What came of a plan: seconds, how it ended, and what a judge found."""

    seconds: float
    status: str
    wrong: str


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
    robots: Callable[[int, Generator], sn.Robot] = robot_of


def _meshed(walls: Callable[[sn.Robot, Floats, Generator], list[sn.Box] | None]) -> Around:
    """The same walls as one mesh."""

    def around(robot: sn.Robot, knots: Floats, rng: Generator) -> list[Obstacle] | None:
        boxes = walls(robot, knots, rng)
        return None if boxes is None else [one_mesh(boxes, robot)]

    return around


_DOORS: dict[str, Callable[[sn.Robot, Floats, Generator], list[sn.Box] | None]] = {
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
        scene = sn.Scene(list(obstacles))
        if not wrong_in(robot, scene, knots):
            return Hidden(robot, scene, knots)
    raise RuntimeError(f"{family} has no place for seed {seed}")


def examine(place: tuple[str, int]) -> Trial:
    """Plan from where a hidden motion begins to where it ends, and judge the plan."""
    hidden = make(*place)
    motion = sn.plan(hidden.robot, hidden.knots[0], hidden.knots[-1], hidden.scene, time=SECONDS)
    wrong = wrong_in(hidden.robot, hidden.scene, motion.q) if motion.solved else ""
    return Trial(motion.seconds, str(motion.status), wrong)


def measure(plan: Plan, family: str) -> Iterator[Line]:
    """Plan into places of one family."""
    places = [(family, 1000 * plan.seed + STRIDE * i) for i in range(plan.count(COUNT, QUICK))]
    yield from lines_of(family, list(plan.track(in_processes(examine, places, alone=plan.quick), family, len(places))))


def lines_of(family: str, trials: Sequence[Trial]) -> Iterator[Line]:
    """Sum up plans: those count that are called proved, in time, and to which no judge objects."""
    good = sum(trial.status == "solved" and trial.seconds <= SECONDS and not trial.wrong for trial in trials)
    times = Times.of([trial.seconds for trial in trials])
    goal = Goal(95.0, at_most=False)
    yield Line(PLANNED, family, 100.0 * good / len(trials), "%", goal, times, (good, len(trials)))
    yield Line(FALSE, family, sum(bool(trial.wrong) for trial in trials), "", Goal(0.0, correctness=True))


PARTS = {f"known {family}": partial(measure, family=family) for family in FAMILIES}
"""Pieces of the experiment, by name."""
