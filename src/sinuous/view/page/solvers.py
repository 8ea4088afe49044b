"""Solvers that are kept while what they were prepared for stays: only targets and places of obstacles change."""

import warnings
from dataclasses import dataclass
from typing import Any

from sinuous.answer.solution import Solution
from sinuous.base.arguments import MethodName
from sinuous.base.checks import Floats
from sinuous.base.errors import SuspiciousInput
from sinuous.model.robot import Robot
from sinuous.motion.job import Job
from sinuous.problem.target import Target
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.memory import Memory
from sinuous.solver.options import TIME, SolveOptions
from sinuous.solver.solver import Solver

QUICK = 0.01
"""Budget, in seconds, of a solve while something is dragged."""


@dataclass(frozen=True)
class Settings:
    """How the page solves.

    Attributes
    ----------
    method : str
    beside : str or None
        A second method, whose answer stands beside that of the first.
    seed : int
    time : float
        Budget in seconds, when nothing is dragged.
    """

    method: MethodName = "newton"
    beside: MethodName | None = None
    seed: int = 0
    time: float = TIME


@dataclass(frozen=True)
class PageQuestion:
    """What is asked of a method at one moment.

    Attributes
    ----------
    job : Job
    scene : Snapshot
        Its obstacles as they are at that moment, standing still.
    targets : tuple of Target
        To be met at once.
    settings : Settings
    initial : ndarray (n, 3)
    number : int
        Of the state of the page that it is asked in; an answer to an older one is out of date.
    """

    job: Job
    scene: Snapshot
    targets: tuple[Target, ...]
    settings: Settings
    initial: Floats
    number: int


def serving(memory: Memory | None, robot: Robot) -> Memory | None:
    """Return a memory as long as it is of this robot: people change robots."""
    return memory if memory is not None and memory._serves(robot) else None


class Solvers:
    """Answers questions, one after the other, in one thread.

    Parameters
    ----------
    routes : bool
        Whether to search for routes where the first starts fail.
    memory : Memory, optional
        Shapes to begin from, as long as the robot is theirs; what is solved is added.
    """

    def __init__(self, routes: bool, memory: Memory | None = None) -> None:
        self._routes, self._memory = routes, memory
        self._known: tuple[Any, ...] | None = None
        self._solver: Solver | None = None

    def solver(self, question: PageQuestion) -> Solver:
        """Return a solver for what is asked.

        Raises
        ------
        InputError
            When the method does not handle the robot, or what is preferred.
        """
        job, own, snapshot = question.job, question.settings, question.scene
        place = len(snapshot) if own.method == "newton" else snapshot  # others sample the scene once
        known = (job.robot, job.tolerance, job.prefer, own.method, own.seed, own.time, place)
        if self._solver is None or known != self._known:
            options = SolveOptions(
                tolerance=job.tolerance,
                method=own.method,
                prefer=job.prefer,
                time=own.time,
                seed=own.seed,
                routes=self._routes,
                memory=serving(self._memory, job.robot),
            )
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", SuspiciousInput)  # the notes of the page say it
                self._solver = Solver._for_one_query(job.robot, Scene.of(snapshot), **vars(options))
            self._known = known
        self._solver.scene.become(snapshot)
        return self._solver

    def solve(self, question: PageQuestion, time: float | None = None) -> Solution:
        """Meet the targets from the shape on the page; `time` in seconds, by default that of the question."""
        return self.solver(question).solve(question.targets, question.initial, time=time)
