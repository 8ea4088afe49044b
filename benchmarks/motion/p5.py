"""P5: plans between random states in random clutter, after the planning benchmark of CR-Solver (2026).

n sections of length 1, bent by up to half a turn; n^3 spheres, or more of them, with centres even in a cube of
half-side n and radii from 0.15 to 0.30, off the straight robot; start and goal are drawn evenly from the states that
are clear, with tips at least a tenth of the length apart. The body has a radius of 0.05 and must not run through
itself. Planners of OMPL (Sucan, Moll & Kavraki 2012) plan some pairs, over the same proofs of states and motions.
"""

from collections.abc import Callable, Iterator
from functools import cache, partial
from importlib.util import find_spec
from itertools import islice
from statistics import median
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness import Goal, Line, Plan, Times, Trial, counted, in_processes, refuted, timed
from benchmarks.judges import self_collision
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import wrong_in
from benchmarks.problems import random_configurations, target_at
from sinuous.base.checks import Floats
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import VERDICT
from sinuous.solver.certificates.steps import Prover

OTHER_PLANNERS = ("RRTConnect", "BITstar")
"""Those to compare with, where OMPL is there; the second goes on to shorten the way until its time is over."""


def plan_by(name: str, task: "Task") -> tuple[bool, float]:
    """Return whether a planner of OMPL found a way, and the seconds that it took."""
    from ompl import base, geometric, util  # noqa: PLC0415

    util.setLogLevel(util.LogLevel.LOG_ERROR)
    pair = task.pair
    n, prover = len(pair.start), Prover(pair.robot, pair.scene.snapshot())
    space, bounds = base.RealVectorStateSpace(2 * n), base.RealVectorBounds(2 * n)
    bounds.setLow(-np.pi)
    bounds.setHigh(np.pi)
    space.setBounds(bounds)

    def clear(one: Any, other: Any, *_: Any) -> bool:
        q = np.array([[(state[2 * i], state[2 * i + 1], 1.0) for i in range(n)] for state in (one, other)])
        within = (np.hypot(q[..., 0], q[..., 1]) <= np.pi).all()
        return bool(within and prover.prove(q, slack=1.0)[0, VERDICT] == CLEAR)

    class Proof(base.MotionValidator):  # type: ignore[misc]
        checkMotion = staticmethod(clear)  # noqa: N815

    ends = [space.allocState(), space.allocState()]
    for state, q in zip(ends, (pair.start, pair.goal), strict=True):
        for i, value in enumerate(q[:, :2].ravel().tolist()):
            state[i] = value
    setup = geometric.SimpleSetup(space)
    setup.setStateValidityChecker(lambda state: clear(state, state))
    information = setup.getSpaceInformation()
    information.setMotionValidator(Proof(information))
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(getattr(geometric, name)(information))
    seconds = timed(setup.solve, PATIENCE)[1]
    return bool(setup.haveExactSolutionPath()), seconds


RADIUS = 0.05

TOGETHER, MOST_DRAWS = 64, 4096
"""States that are drawn at once, and how many before the spheres are drawn anew."""

COUNT, QUICK = 200, 4
"""Pairs of one number of segments and one density."""

SECONDS = 1.0
"""Budget of a plan."""

COMPARED, PATIENCE = 20, 1.0
"""Pairs that the planners of others plan, too, and the seconds that each has for one."""

PLANNED = "P5: planned and proved in time, and found clear by the judges"
FALSE = "P5: motions called proved in which a judge finds a collision"
MEDIAN = "P5: median time of a plan (one core, warm, with the proof of every step)"
SHORTENED = "P5: median time with 10 shortcuts tried"
OTHERS = "P5: compared, over the same proofs: planned in time"


class Pair(NamedTuple):
    """A robot among spheres, and two of its configurations (n, 3)."""

    robot: sn.Robot
    scene: sn.Scene
    start: Floats
    goal: Floats

    @property
    def target(self) -> sn.Target:
        """The pose of the tip at the goal."""
        return target_at(self.robot.tip(self.goal), "rotation")


class Task(NamedTuple):
    """A pair, whether the pose of the goal's tip is asked for, and how many shortcuts are tried."""

    segments: int
    density: int
    number: int
    seed: int
    to_target: bool = False
    shortcuts: int = 0

    @property
    def pair(self) -> Pair:
        """The pair."""
        return draw(self.segments, self.density, self.number, self.seed)


def draw(segments: int, density: int, number: int, seed: int) -> Pair:
    """Return pair `number` of a seed, with `density` times n^3 spheres."""
    rng = np.random.default_rng([seed, segments, density, number])
    robot = sn.Robot([sn.Segment(1.0, np.pi, radius=RADIUS)] * segments)
    while True:
        scene = sn.Scene(islice(_spheres(segments, rng), density * segments**3))
        found = _states(robot, scene, rng)
        if found is not None:
            return Pair(robot, scene, *found)


def _spheres(n: int, rng: Generator) -> Iterator[sn.Sphere]:
    """Draw spheres off the straight robot, without end."""
    while True:
        center, radius = rng.uniform(-n, n, 3), float(rng.uniform(0.15, 0.30))
        if np.linalg.norm(center - [0.0, 0.0, np.clip(center[2], 0.0, n)]) > radius + RADIUS:
            yield sn.Sphere(center, radius)


def _states(robot: sn.Robot, scene: sn.Scene, rng: Generator) -> tuple[Floats, Floats] | None:
    """Draw a start and a goal; none where the spheres leave too little room."""
    clearances, free = Clearances(robot, scene), np.empty((0, len(robot), 3))
    for _ in range(MOST_DRAWS // TOGETHER):
        q = random_configurations(robot, TOGETHER, rng)
        q = q[clearances.least(q, 0.0) > 0.0]
        free = np.concatenate([free, q[self_collision.surely_clear(robot, q)]])
        tips = [robot.tip(one)[:3, 3] for one in free]
        far = [i for i in range(1, len(free)) if np.linalg.norm(tips[0] - tips[i]) >= 0.1 * robot.mean_length]
        if far:
            return free[0], free[far[0]]
    return None


def examine(task: Task) -> Trial:
    """Draw a pair, plan the way from one to the other, and judge it."""
    _load(task.segments)
    pair = task.pair
    planner = sn.Planner(pair.robot, pair.scene, time=SECONDS, shortcuts=task.shortcuts)
    goal = pair.target if task.to_target else pair.goal
    motion, seconds = timed(planner.plan, pair.start, goal)
    wrong = wrong_in(pair.robot, pair.scene, motion.q) if motion.solved else ""
    return Trial(task.number, seconds, str(motion.status), wrong)


@cache
def _load(segments: int) -> None:
    """Load the kernels in this process, so that no measured plan does."""
    pair = draw(segments, 1, 0, 2**30)
    sn.Solver(pair.robot, pair.scene)  # with the search for routes, which a planner leaves until a target needs it
    planner = sn.Planner(pair.robot, pair.scene)
    planner.plan(pair.start, pair.goal)
    planner.plan(pair.start, pair.target)


def measure(plan: Plan, segments: int, density: int, to_target: bool = False) -> Iterator[Line]:
    """Plan all pairs of a kind."""
    what = f"{segments} segments, {density * segments**3} spheres, to a {'target' if to_target else 'configuration'}"
    plain = density == 1 and not to_target
    tasks = [Task(segments, density, i, plan.seed, to_target) for i in range(plan.count(COUNT, QUICK))]
    trials = list(in_processes(examine, tasks, alone=plan.quick))
    limit, share = (0.5, 98.0) if to_target else (1.0, 99.0) if segments == 8 else (0.1, 99.5) if plain else (1.0, 97.0)
    yield from lines_of(what, trials, limit, share)
    for name in OTHER_PLANNERS if plain and segments in (3, 6) and find_spec("ompl") else ():
        found, spent = zip(*in_processes(partial(plan_by, name), tasks[:COMPARED], alone=plan.quick), strict=True)
        good, count = sum(found), len(found)
        cut = f"the first {count} of {len(tasks)} pairs, {PATIENCE:g} s for each"
        told = f"{name} of OMPL, {what}"
        yield Line(OTHERS, told, 100.0 * good / count, "%", None, Times.of(spent), (good, count), cut)
    if plain:
        tasks = [task._replace(shortcuts=10) for task in tasks]
        shorter = list(in_processes(examine, tasks, alone=plan.quick))
        yield Line(SHORTENED, what, median(trial.seconds for trial in shorter), "ms")
        yield refuted(FALSE, f"{what}, shortened", {"": shorter})


def lines_of(what: str, trials: list[Trial], limit: float, share: float) -> Iterator[Line]:
    """Sum up the trials of one kind: so large a share (%) is to be planned within the limit (s)."""
    times = Times.of([trial.seconds for trial in trials])
    yield from counted(PLANNED, FALSE, what, trials, limit, share)
    yield Line(MEDIAN, what, times.median, "ms", Goal(1e-3) if limit == 0.1 else None)


SIZES = (3, 4, 5, 6)
"""Numbers of segments, of every kind of pairs."""

PARTS: dict[str, Callable[[Plan], Iterator[Line]]] = {
    **{f"P5, {n} segments": partial(measure, segments=n, density=1) for n in (*SIZES, 8)},
    **{f"P5, {n} segments, 2 times as dense": partial(measure, segments=n, density=2) for n in SIZES},
    **{f"P5, {n} segments, 4 times as dense": partial(measure, segments=n, density=4) for n in SIZES},
    **{f"P5, {n} segments, targets": partial(measure, segments=n, density=1, to_target=True) for n in SIZES},
}
