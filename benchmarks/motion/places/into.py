"""Plans into the intricate places of `clutter`: to the hidden shape, straight from outside, and from another shape.

Both ends are clear; that there is a motion from one to the other is not known. `known` asks where it is.
"""

from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

import sinuous as sn
from benchmarks.harness.lines import Line
from benchmarks.harness.plan import Plan
from benchmarks.motion.judged import collides
from benchmarks.motion.places.motions import straight
from benchmarks.motion.places.trials import COUNT, QUICK, SECONDS, STRIDE, Trial, lines_of
from benchmarks.places import FAMILIES, Place, make
from benchmarks.solvers.parallel import in_processes
from sinuous.base.checks import Floats

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


def measure(plan: Plan, family: str) -> Iterator[Line]:
    """Plan into places of one family from both starts; where there is none that is clear, there is nothing to plan."""
    seeds = [1000 * plan.seed + STRIDE * i for i in range(plan.count(COUNT, QUICK))]
    for begin in (STRAIGHT, OTHER):
        what, tasks = f"{family}, from {begin}", [Task(family, seed, begin) for seed in seeds]
        trials = list(plan.track(in_processes(examine, tasks, alone=plan.quick), what, len(tasks)))
        yield from lines_of(what, [trial for trial in trials if trial.begins], PLANNED, FALSE)


def examine(task: Task) -> Trial:
    """Plan into one place, and judge the motion."""
    place = make(task.family, task.seed)
    start = straight(place.robot) if task.begin == STRAIGHT else elsewhere(place)
    if start is None:
        return Trial(0.0, False, "", "")
    motion = sn.plan(place.robot, start, place.hidden_q, place.scene, time=SECONDS)
    begins = motion.status is not sn.Status.START_BLOCKED
    wrong = collides(place.robot, place.scene, motion.q) if motion.solved else ""
    return Trial(motion.seconds, begins, str(motion.status), wrong)


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
