"""A method whose whole solve is one compiled call: its groups, a workspace for each thread, and its outcomes."""

import threading
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import RECORD_WIDTH, TARGET_WIDTH, Budget, Outcome, answer_size
from sinuous.methods.capabilities import Capabilities
from sinuous.methods.method import Call, Case
from sinuous.problem.problem import Problem, settings_group
from sinuous.robot.robot import robot_group
from sinuous.scene.snapshot import Snapshot


class Entry(NamedTuple):
    """A compiled search, and what it needs besides the groups of robot and scene.

    Attributes
    ----------
    search : callable
        Takes groups of robot, scene and settings, then targets (m, t, 15), initial configurations (m, g, n, 3), budget,
        workspace, and the answers (m, 11 + 3 n) that it fills; see `sinuous.kernels.tables`.
    size : callable
        Numbers (float64) of workspace for this many targets at once.
    options : ndarray
        Options of the method, as the kernel reads them from the end of the settings.
    """

    search: Callable[..., Any]
    size: Callable[[int], int]
    options: Floats | tuple[()] = ()


class Compiled:
    """A prepared method behind one entry.

    Parameters
    ----------
    name : str
    capabilities : Capabilities
    entry : Entry
    case : Case
    """

    def __init__(self, name: str, capabilities: Capabilities, entry: Entry, case: Case) -> None:
        self._name, self._capabilities, self._entry = name, capabilities, entry
        self._robot = robot_group(case.robot)
        self._settings = settings_group(case.robot, case.tolerance, case.preferences, entry.options)
        self._segments = len(case.robot)
        self._local = threading.local()
        self._load(case)

    def _load(self, case: Case) -> None:
        """Compile the entry, or load it from the cache: it is called for no problem at all."""
        nothing = np.zeros((0, 1, TARGET_WIDTH)), np.empty((0, 0, self._segments, 3))
        call = self._call(case.scene.snapshot(), *nothing, (0, 0, 0, 0.0))
        call.entry(*call.arguments)

    def build(self, problem: Problem, initial: Floats, budget: Budget) -> Call:
        """Return what `run` would call; see `Method.build`."""
        self._capabilities.refuse_targets(self._name, problem._rows, self._segments)
        return self._call(problem.scene, problem._rows[None], initial[None], budget)

    def run(self, problem: Problem, initial: Floats, budget: Budget, reference: Floats | None = None) -> Outcome:
        """Solve one problem; see `Method.run`."""
        return _answered(self.build(problem, initial, budget))[0]

    def run_many(self, scene: Snapshot, rows: Floats, initial: Floats, budget: Budget, answers: Floats) -> None:
        """Solve many problems; see `Method.run_many`."""
        if not self._capabilities.any_target:
            for each in rows:
                self._capabilities.refuse_targets(self._name, each, self._segments)
        groups = self._robot, self._scene_group(scene), self._settings
        self._entry.search(*groups, rows, initial, budget, self._workspace(rows.shape[1]), answers)

    def _call(self, scene: Snapshot, rows: Floats, initial: Floats, budget: Budget) -> Call:
        answers = np.empty((len(rows), answer_size(self._segments)))
        groups = self._robot, self._scene_group(scene), self._settings
        return Call(self._entry.search, (*groups, rows, initial, budget, self._workspace(rows.shape[1]), answers))

    def _scene_group(self, scene: Snapshot) -> Floats | None:
        """Group of the scene, as the entry takes it."""
        return scene._kernel_group

    def _workspace(self, targets: int) -> Floats:
        """Scratch of this thread, for so many targets at once."""
        if getattr(self._local, "targets", -1) < targets:
            self._local.targets = targets
            self._local.workspace = np.empty(self._entry.size(targets))
        workspace: Floats = self._local.workspace
        return workspace


def _answered(call: Call) -> list[Outcome]:
    """Make a call, and read its answers."""
    call.entry(*call.arguments)
    return as_outcomes(call.arguments[-1])


def as_outcomes(answers: Floats) -> list[Outcome]:
    """Outcomes of a batch of answers (m, 11 + 3 n)."""
    shapes = answers[:, RECORD_WIDTH:].reshape(len(answers), -1, 3).copy()
    return [
        Outcome.from_record(q, record) for q, record in zip(shapes, answers[:, :RECORD_WIDTH].tolist(), strict=True)
    ]
