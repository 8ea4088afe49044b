"""One robot, judged by its tasks: each is tried, and solved and proved, or not; and what is minimised.

Objectives are numbers that a robot has, and those that its answers to the tasks have.
"""

import math
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, SuspiciousInput
from sinuous.kernels.packing import scales_of
from sinuous.model.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solver.solver import Solver
from sinuous.studies.designing.search import Space
from sinuous.studies.tasks.tasks import SOLVED, Done, Meet, Task

Objective = Literal["actuators", "length", "bend", "travel", "tension", "clearance", "uncovered"]
"""What may be minimised.

- `actuators`: their number; of a robot without any, the coordinates that can move;
- `length`: of the whole body, the largest that it may have;
- `bend`: the largest of any segment in any answer, rad;
- `travel`: the largest way of the value of any actuator, between all answers and the straight robot;
- `tension`: the largest of any elastic actuator in any answer;
- `clearance`: the least proved of any answer; it is maximised, so its sign is turned;
- `uncovered`: the share of the targets that are not met. All others are asked only of robots that do all tasks.
"""

OBJECTIVES: tuple[Objective, ...] = get_args(Objective)

MOST_OBJECTIVES = 2
"""Most objectives at once."""


def read_objectives(minimise: Any, template: Robot) -> tuple[Objective, ...]:
    """Check what is to be minimised.

    Raises
    ------
    InputError
    """
    listed = [minimise] if isinstance(minimise, str) else list(minimise) if isinstance(minimise, Iterable) else []
    if not 1 <= len(listed) <= MOST_OBJECTIVES:
        raise InputError("minimise", "", minimise, f"one or two of {', '.join(OBJECTIVES)}")
    for name in listed:
        if name not in OBJECTIVES:
            raise InputError("minimise", "", name, f"one or two of {', '.join(OBJECTIVES)}")
    if len(set(listed)) < len(listed):
        raise InputError("minimise", "names one twice", listed, "two different ones")
    if "travel" in listed and not len(template.drive):
        raise InputError("minimise", "needs actuators", "travel", "a robot with tendons, chambers or actuators")
    if "tension" in listed and template.drive.elastic is None:
        raise InputError("minimise", "needs a stiffness", "tension", "a robot with elastic tendons or chambers")
    return tuple(name for name in listed if name in OBJECTIVES)


def of_robot(name: Objective, robot: Robot) -> float | None:
    """What a robot has whatever its tasks; `None` where answers say it."""
    if name == "actuators":
        moves = scales_of(robot.limits) > 0.0
        return float(len(robot.drive) or moves.sum())
    if name == "length":
        return float(sum(segment.length[1] for segment in robot.segments))
    return None


def of_answers(name: Objective, robot: Robot, shapes: Sequence[Floats], clearance: float | None, share: float) -> float:
    """What answers (..., n, 3) to all tasks have."""
    own = of_robot(name, robot)
    if own is not None:
        return own
    if name == "uncovered":
        return 1.0 - share
    if name == "clearance":
        return 0.0 if clearance is None else -clearance
    return _of_shapes(
        name,
        robot,
        np.concatenate([np.empty((0, len(robot), 3)), *(shape.reshape(-1, len(robot), 3) for shape in shapes)]),
    )


def _of_shapes(name: Objective, robot: Robot, q: Floats) -> float:
    """What the shapes (k, n, 3) of all answers have."""
    if not len(q):
        return 0.0
    if name == "bend":
        return float(np.hypot(q[..., 0], q[..., 1]).max())
    if name == "tension":
        elastic = robot.drive.elastic
        return math.inf if elastic is None else float(np.abs(elastic.balance(q).tensions).max())
    values = robot.to_actuators(np.concatenate([q, robot.straight[None]]))
    return float(np.ptp(values, axis=0).max())


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
