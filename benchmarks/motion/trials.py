"""One pair, planned and judged: what P5 repeats many times."""

from functools import cache
from time import perf_counter
from typing import NamedTuple

from benchmarks.motion import peers
from benchmarks.motion.judged import collides
from benchmarks.motion.pairs import Pair, draw
from sinuous.motion.plan import Planner
from sinuous.problem.target import Target
from sinuous.solver.solver import Solver

CONFIGURATION, TARGET = "configuration", "target"
"""What may be asked for: the goal itself, or the pose of its tip."""


class Task(NamedTuple):
    """A pair, what is asked for, the budget (s), how many shortcuts, and the budget of others, who plan it, too (s)."""

    segments: int
    density: int
    number: int
    seed: int
    goal: str = CONFIGURATION
    seconds: float = 1.0
    shortcuts: int = 0
    peers: float = 0.0


class Trial(NamedTuple):
    """What came of it: the time of the call, status, what a judge found wrong (nothing: ""), steps, and of others."""

    number: int
    seconds: float
    status: str
    wrong: str
    steps: int
    others: dict[str, tuple[float, bool]]

    @property
    def solved(self) -> bool:
        """Whether a motion was called proved, and no judge objects."""
        return self.status == "solved" and not self.wrong


def examine(task: Task) -> Trial:
    """Draw a pair, plan the way from one to the other, and judge it."""
    _load(task.segments)
    pair = draw(task.segments, task.density, task.number, task.seed)
    planner = Planner(pair.robot, pair.scene, time=task.seconds, shortcuts=task.shortcuts)
    goal = pair.goal if task.goal == CONFIGURATION else _target(pair)
    began = perf_counter()
    motion = planner.plan(pair.start, goal)
    seconds = perf_counter() - began
    wrong = collides(pair.robot, pair.scene, motion.q) if motion.solved else ""
    others = peers.plan_all(pair, task.peers) if task.peers else {}
    return Trial(task.number, seconds, str(motion.status), wrong, len(motion.q) - 1, others)


def _target(pair: Pair) -> Target:
    tip = pair.robot.tip(pair.goal)
    return Target(tip[:3, 3], rotation=tip[:3, :3])


@cache
def _load(segments: int) -> None:
    """Load the kernels in this process, so that no measured plan does."""
    pair = draw(segments, 1, 0, 2**30)
    Solver(pair.robot, pair.scene)  # with the search for routes, which a planner leaves until a target needs it
    planner = Planner(pair.robot, pair.scene)
    planner.plan(pair.start, pair.goal)
    planner.plan(pair.start, _target(pair))
