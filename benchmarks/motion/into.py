"""Plans into the intricate places of `clutter`: to the hidden shape, straight from outside, and from another shape."""

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

STRIDE = 7
"""From one place's seed to the next: eight places have robots of all sizes, with stages and without."""

SECONDS = 5.0

AWAY, TRIES = (0.3, 0.6), 30
"""How far the tip of another shape is from the hidden one's, in lengths of the robot, and how many are tried."""

STRAIGHT, OTHER = "the straight robot", "another shape"
"""Where plans begin: straight, or in a shape that reaches a place away from the hidden tip."""

PLANNED = "plans into places, to the hidden shape: planned and proved within 5 s, and found clear by the judges"
FALSE = "plans into places: motions called proved in which a judge finds a collision"


class Task(NamedTuple):
    """A place, by its name, and where a plan into it begins."""

    family: str
    seed: int
    begin: str


class Trial(NamedTuple):
    """What came of it: seconds, whether there is such a start, how it ended, and what a judge found."""

    seconds: float
    begins: bool
    status: str
    wrong: str

    @property
    def good(self) -> bool:
        """Whether a motion was called proved, in time, and no judge objects."""
        return self.status == "solved" and self.seconds <= SECONDS and not self.wrong


def measure(plan: Plan, family: str) -> Iterator[Line]:
    """Plan into places of one family from both starts; where there is none that is clear, there is nothing to plan."""
    seeds = [1000 * plan.seed + STRIDE * i for i in range(plan.count(COUNT, QUICK))]
    for begin in (STRAIGHT, OTHER):
        what, tasks = f"{family}, from {begin}", [Task(family, seed, begin) for seed in seeds]
        trials = list(plan.track(in_processes(examine, tasks, alone=plan.quick), what, len(tasks)))
        yield from lines_of(what, [trial for trial in trials if trial.begins])


def lines_of(what: str, begun: list[Trial]) -> Iterator[Line]:
    """Sum up trials that have a start."""
    if begun:
        good, times = sum(trial.good for trial in begun), Times.of([trial.seconds for trial in begun])
        reached = 100.0 * good / len(begun)
        yield Line(PLANNED, what, reached, "%", Goal(95.0, at_most=False), times, (good, len(begun)))
    yield Line(FALSE, what, sum(bool(trial.wrong) for trial in begun), "", Goal(0.0, correctness=True))


def examine(task: Task) -> Trial:
    """Plan into one place, and judge the motion."""
    place = make(task.family, task.seed)
    start = _straight(place) if task.begin == STRAIGHT else elsewhere(place)
    if start is None:
        return Trial(0.0, False, "", "")
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


def elsewhere(place: Place) -> Floats | None:
    """Return a clear shape (n, 3) whose tip is away from the hidden one; `None` where none is found."""
    rng, solver = np.random.default_rng(place.seed), sn.Solver(place.robot, place.scene)
    tip = place.robot.tip(place.hidden_q)[:3, 3]
    for _ in range(TRIES):
        way = rng.normal(size=3)
        far = place.robot.mean_length * rng.uniform(*AWAY)
        solution = solver.solve(sn.Target(tip + far * way / np.linalg.norm(way)))
        if solution.solved:
            return np.array(solution.q)
    return None


PARTS = {f"into {family}": partial(measure, family=family) for family in FAMILIES}
