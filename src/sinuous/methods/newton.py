"""Our own method: a damped Newton step of the whole robot in two sweeps (see `sinuous.kernels.step.sweeps`)."""

import threading
from collections.abc import Sequence

import numpy as np

from sinuous import packing
from sinuous.checks import Floats
from sinuous.kernels.compile import announce
from sinuous.kernels.solve.preferences import prefer
from sinuous.kernels.solve.search import search, search_many
from sinuous.kernels.step.states import workspace_size
from sinuous.kernels.tables import SOLVED, Outcome, answer_size
from sinuous.methods.compiled import as_outcomes
from sinuous.methods.method import Budget, Call
from sinuous.problem.preferences import Preferences
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.problem.tolerance import Tolerance
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene


class Newton:
    """The method `newton`, prepared: groups for the kernels, and one workspace a thread."""

    def __init__(self, robot: Robot, scene: Scene, tolerance: Tolerance, preferences: Preferences) -> None:
        self._robot = packing.robot_group(robot)
        self._settings = packing.settings_group(robot, tolerance, preferences)
        self._sizes = len(robot), len(robot.actuation), len(scene)
        self._preferences = preferences
        self._local = threading.local()
        announce(search)
        nowhere = Problem.prepared(robot, (Target((0.0, 0.0, 0.0)),), scene.snapshot(), tolerance)
        outcome = self.run(nowhere, np.empty((0, len(robot), 3)), (0, 0, 0, 0.0))  # compiles, or loads from the cache
        if preferences:
            announce(prefer)
            outcome.q[:] = 0.0
            self._prefer(outcome, nowhere, None, 0.0)

    def build(self, problem: Problem, initial: Floats, budget: Budget) -> Call:
        """Return what `run` would call; see `Method.build`."""
        rows = problem.rows
        best, workspace = np.empty((self._sizes[0], 3)), self._workspace(len(rows))
        return Call(search, (self._robot, problem.scene.group, self._settings, rows, initial, budget, workspace, best))

    def run(self, problem: Problem, initial: Floats, budget: Budget, reference: Floats | None = None) -> Outcome:
        """Solve one problem; see `Method.run`."""
        arguments = self.build(problem, initial, budget).arguments
        outcome = Outcome(arguments[-1], *search(*arguments))
        if self._preferences and outcome.code == SOLVED:
            return self._prefer(outcome, problem, reference, budget[3])
        return outcome

    def run_many(self, problems: Sequence[Problem], initial: Floats, budget: Budget) -> list[Outcome]:
        """Solve many problems; see `Method.run_many`."""
        announce(search_many)
        rows = np.stack([each.rows for each in problems])
        answers = np.empty((len(rows), answer_size(self._sizes[0])))
        group, workspace = problems[0].scene.group, self._workspace(rows.shape[1])
        search_many(self._robot, group, self._settings, rows, initial, budget, workspace, answers)
        outcomes = as_outcomes(answers)
        if not self._preferences:
            return outcomes
        given = initial if initial.shape[1] else [[None]] * len(outcomes)
        return [
            self._prefer(outcome, problem, own[0], budget[3]) if outcome.code == SOLVED else outcome
            for outcome, problem, own in zip(outcomes, problems, given, strict=True)
        ]

    def _prefer(self, outcome: Outcome, problem: Problem, reference: Floats | None, seconds: float) -> Outcome:
        """Improve a solved outcome, in place, by what is preferred; `reference` (n, 3): what to stay close to."""
        near = outcome.q.copy() if reference is None else np.array(reference)
        proved = outcome.position_error, outcome.angle_error, outcome.clearance, seconds
        groups = self._robot, problem.scene.group, self._settings, problem.rows
        used, *better = prefer(*groups, near, proved, self._workspace(len(problem.rows)), outcome.q)
        position_error, angle_error, clearance = better
        return outcome._replace(
            iterations=outcome.iterations + used,
            position_error=position_error,
            angle_error=angle_error,
            clearance=clearance,
        )

    def _workspace(self, targets: int) -> Floats:
        """Scratch of this thread, for so many targets."""
        if getattr(self._local, "targets", -1) < targets:
            self._local.targets = targets
            self._local.workspace = np.empty(workspace_size(*self._sizes, targets))
        workspace: Floats = self._local.workspace
        return workspace
