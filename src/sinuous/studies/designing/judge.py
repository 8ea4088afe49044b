"""One robot, judged by its tasks: each is tried, and solved and proved, or not."""

import math
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, SuspiciousInput
from sinuous.model.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solver.solver import Solver
from sinuous.studies.designing.fields import Space
from sinuous.studies.designing.objectives import Objective, of_answers, of_robot
from sinuous.studies.tasks.tasks import SOLVED, Done, Meet, Task


class Judged(NamedTuple):
    """What a robot reached.

    Attributes
    ----------
    done : int
        How many tasks are done.
    share : float
        Of all targets that are met, a mean over the tasks.
    objectives : tuple of float
    failed : int
        Number of the first task that is not done, -1 where all are.
    answers : ndarray (t, N, 3)
        Configurations for targets that are met, of N segments at most; NaN elsewhere.
    """

    done: int
    share: float
    objectives: tuple[float, ...]
    failed: int
    answers: Floats


class Judge:
    """Judges robots; may be pickled.

    Parameters
    ----------
    space : Space
    tasks : mapping of str to Task
    scene : Scene
    minimise : tuple of str
    options : mapping
        Of solvers.
    """

    def __init__(
        self,
        space: Space,
        tasks: Mapping[str, Task],
        scene: Scene,
        minimise: tuple[Objective, ...],
        options: Mapping[str, Any],
    ) -> None:
        self.space, self.tasks, self.scene = space, dict(tasks), scene
        self.minimise, self.options = minimise, dict(options)

    def solver(self, robot: Robot) -> Solver:
        """Return a solver for a robot; what is suspicious has been said of the template."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SuspiciousInput)
            return Solver(robot, self.scene, **self.options)

    def judge(
        self,
        robot: Robot | None,
        bounds: Floats | None = None,
        order: Sequence[int] | None = None,
        stops: bool = False,
        begin: Floats | None = None,
    ) -> Judged:
        """Judge one robot.

        Parameters
        ----------
        robot : Robot, optional
            `None` stands for values that make none.
        bounds : ndarray (o,), optional
            The least known of each objective: a robot that is known to be no better is not tried.
        order : sequence of int, optional
            In which the tasks are tried: those first that fail most often.
        stops : bool
            Whether the first task that is not done ends it: where robots are known that do all.
        begin : ndarray (t, N, 3), optional
            Answers of a robot nearby, which solves begin from; NaN where none is known.
        """
        if robot is None:
            return self._failing(0, 0.0, 0)
        if bounds is not None and self._is_beyond(robot, bounds):
            return self._failing(0, 0.0, -2)
        try:
            solver = self.solver(robot)
            for task in self.tasks.values():
                task.check(robot)
        except InputError:
            return self._failing(0, 0.0, 0)
        whole, listed = "uncovered" in self.minimise, list(self.tasks.values())
        done: dict[int, Done] = {}
        for number in range(len(listed)) if order is None else order:
            start = None if begin is None or np.isnan(begin[number, 0, 0]) else begin[number, : len(robot)]
            task = listed[number]
            done[number] = task.do(solver, start, explained=False) if isinstance(task, Meet) else task.do(solver)
            if stops and not whole and done[number].status != SOLVED:
                return self._failing(len(done) - 1, 0.0, number)
        return self._judged(robot, [done[number] for number in range(len(listed))], whole)

    def _judged(self, robot: Robot, done: Sequence[Done], whole: bool) -> Judged:
        """Sum up what became of all tasks; with `whole`, objectives count also where not all are done."""
        solved = [each.status == SOLVED for each in done]
        share = sum(each.share for each in done) / len(done)
        failed = -1 if all(solved) else solved.index(False)
        if failed >= 0 and not whole:
            return self._failing(sum(solved), share, failed)
        clear = [each.clearance for each in done if each.clearance is not None]
        shapes = [each.shapes for each in done if each.shapes is not None]
        own = (of_answers(name, robot, shapes, min(clear, default=None), share) for name in self.minimise)
        answers = self._no_answers()
        for row, task, each in zip(answers, self.tasks.values(), done, strict=True):
            if isinstance(task, Meet) and each.shapes is not None:
                row[: len(robot)] = each.shapes[0]
        return Judged(sum(solved), share, tuple(own), failed, answers)

    def _no_answers(self) -> Floats:
        return np.full((len(self.tasks), self.space.segments, 3), np.nan)

    def _failing(self, done: int, share: float, failed: int) -> Judged:
        return Judged(done, share, (math.inf,) * len(self.minimise), failed, self._no_answers())

    def _is_beyond(self, robot: Robot, bounds: Floats) -> bool:
        """Whether what is known of a robot without trying is no better than a robot that is known."""
        known = [of_robot(name, robot) for name in self.minimise]
        return all(value is not None and value >= bound for value, bound in zip(known, bounds, strict=True))
