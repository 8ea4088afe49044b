"""Plans into the intricate places of `clutter`: from outside, straight, to the hidden shape."""

from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

import sinuous as sn
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.motion.judged import collides
from benchmarks.places import FAMILIES, Place, make
from benchmarks.solvers.parallel import in_processes
from sinuous.checks import Floats

COUNT, QUICK = 8, 1
"""Places of a family."""

SECONDS = 5.0

PLANNED = (
    "plans into places, straight to the hidden shape: planned and proved within 5 s, and found clear by the judges"
)
FALSE = "plans into places: motions called proved in which a judge finds a collision"


class Task(NamedTuple):
    """A place, by its name."""

    family: str
    seed: int


class Trial(NamedTuple):
    """What came of it: seconds, whether the straight robot is clear there, how it ended, and what a judge found."""

    seconds: float
    begins: bool
    status: str
    wrong: str


def measure(plan: Plan, family: str) -> Iterator[Line]:
    """Plan into places of one family; where the straight robot overlaps, there is nothing to plan."""
    tasks = [Task(family, 1000 * plan.seed + i) for i in range(plan.count(COUNT, QUICK))]
    trials = list(plan.track(in_processes(examine, tasks, alone=plan.quick), family, len(tasks)))
    begun = [trial for trial in trials if trial.begins]
    good = sum(trial.status == "solved" and not trial.wrong for trial in begun)
    if begun:
        times = Times.of([trial.seconds for trial in begun])
        reached = 100.0 * good / len(begun)
        yield Line(PLANNED, family, reached, "%", Goal(95.0, at_most=False), times, (good, len(begun)))
    yield Line(FALSE, family, sum(bool(trial.wrong) for trial in begun), "", Goal(0.0, correctness=True))


def examine(task: Task) -> Trial:
    """Plan into one place, and judge the motion."""
    place = make(*task)
    start = _straight(place)
    motion = sn.plan(place.robot, start, place.hidden_q, place.scene, time=SECONDS)
    begins = motion.status is not sn.Status.START_BLOCKED
    wrong = collides(place.robot, place.scene, motion.q) if motion.solved else ""
    return Trial(motion.seconds, begins, str(motion.status), wrong)


def _straight(place: Place) -> Floats:
    """Return the straight robot: every stage drawn in, every other segment at its mean length."""
    lengths = [
        segment.length[0] if segment.max_bend == 0.0 else 0.5 * sum(segment.length) for segment in place.robot.segments
    ]
    return np.stack([np.zeros(len(lengths)), np.zeros(len(lengths)), lengths], axis=-1)


PARTS = {f"into {family}": partial(measure, family=family) for family in FAMILIES}
