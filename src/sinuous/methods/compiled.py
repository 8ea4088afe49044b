"""A method whose whole solve is one compiled call: its groups, a workspace a thread, and its outcomes."""

import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from sinuous import packing
from sinuous.checks import Floats
from sinuous.kernels.compile import announce
from sinuous.kernels.tables import RECORD_WIDTH, TARGET_WIDTH, Outcome, answer_size
from sinuous.methods.capabilities import Capabilities
from sinuous.methods.method import Budget, Call
from sinuous.problem.problem import Problem
from sinuous.problem.tolerance import Tolerance
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot


class Compiled:
    """A prepared method, behind an entry with the arguments of `sinuous.kernels.solve.search.search_many`.

    Parameters
    ----------
    name : str
    capabilities : Capabilities
    search : callable
        The entry: groups of robot and scene, settings with the options of the method, groups of its own, then targets
        (m, t, 15), initial configurations (m, g, n, 3), budget, workspace, and the answers (m, 10 + 3 n) that it fills.
    size : int
        Numbers (float64) that it needs as workspace.
    options : ndarray
        Its options, as the kernel reads them.
    own : tuple of ndarray
        Groups of its own, writable.
    """

    def __init__(
        self,
        name: str,
        capabilities: Capabilities,
        search: Callable[..., Any],
        size: int,
        robot: Robot,
        scene: Scene,
        tolerance: Tolerance,
        options: Floats,
        *own: Floats,
    ) -> None:
        self._robot = packing.robot_group(robot)
        self._settings = packing.settings_group(robot, tolerance, options=options)
        self._own = own
        self._name, self._capabilities, self._search = name, capabilities, search
        self._segments, self._size = len(robot), size
        self._local = threading.local()
        announce(search)
        nothing = np.zeros((0, 1, TARGET_WIDTH)), np.empty((0, 0, len(robot), 3))
        search(*self._call(scene.snapshot(), *nothing, (0, 0, 0, 0.0)).arguments)  # compiles, or loads from the cache

    def build(self, problem: Problem, initial: Floats, budget: Budget) -> Call:
        """Return what `run` would call; see `Method.build`."""
        self._capabilities.refuse_targets(self._name, problem.rows, self._segments)
        return self._call(problem.scene, problem.rows[None], initial[None], budget)

    def run(self, problem: Problem, initial: Floats, budget: Budget, reference: Floats | None = None) -> Outcome:
        """Solve one problem; see `Method.run`."""
        return _answered(self.build(problem, initial, budget))[0]

    def run_many(self, problems: Sequence[Problem], initial: Floats, budget: Budget) -> list[Outcome]:
        """Solve many problems; see `Method.run_many`."""
        for each in problems:
            self._capabilities.refuse_targets(self._name, each.rows, self._segments)
        rows = np.stack([each.rows for each in problems])
        return _answered(self._call(problems[0].scene, rows, initial, budget))

    def _call(self, scene: Snapshot, rows: Floats, initial: Floats, budget: Budget) -> Call:
        answers = np.empty((len(rows), answer_size(self._segments)))
        groups = self._robot, scene.group, self._settings, *self._own
        return Call(self._search, (*groups, rows, initial, budget, self._workspace(), answers))

    def _workspace(self) -> Floats:
        """Scratch of this thread."""
        if not hasattr(self._local, "workspace"):
            self._local.workspace = np.empty(self._size)
        workspace: Floats = self._local.workspace
        return workspace


def _answered(call: Call) -> list[Outcome]:
    """Make a call, and read its answers."""
    call.entry(*call.arguments)
    return as_outcomes(call.arguments[-1])


def as_outcomes(answers: Floats) -> list[Outcome]:
    """Outcomes of a batch of answers (m, 10 + 3 n)."""
    shapes = answers[:, RECORD_WIDTH:].reshape(len(answers), -1, 3).copy()
    return [
        Outcome.from_record(q, record) for q, record in zip(shapes, answers[:, :RECORD_WIDTH].tolist(), strict=True)
    ]
