"""Our own method: a damped Newton step of the whole robot in two sweeps (see `sinuous.kernels.sweeps`)."""

import threading

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.compile import announce
from sinuous.kernels.search import search, workspace_size
from sinuous.methods import Outcome
from sinuous.problem import Preferences, Tolerance
from sinuous.robot import Robot
from sinuous.scene.scene import Scene

ITERATIONS = 60
"""Most iterations from one start."""

MARGIN = 1e-4
"""Clearance that the steps aim for beyond none, of the robot's mean length: room for the proof to decide."""


class Newton:
    """The method `newton`, prepared: tables for the kernels, and one workspace a thread."""

    def __init__(self, robot: Robot, scene: Scene, tolerance: Tolerance, preferences: Preferences) -> None:
        announce(search)
        self._local = threading.local()
        self._sizes = len(robot), len(robot.actuation), len(scene)
        unit = robot.mean_length
        self._tables = (robot.limits.copy(), robot.actuation.copy(), robot.base_row.copy(), robot.tool_row.copy(), scene.table.copy())
        self._scalars = (robot.mount, unit, MARGIN * unit, tolerance.position, tolerance.angle)
        self._wishes = (preferences.start, preferences.bends, preferences.clearance)

    def run(self, rows: Floats, given: Floats, first: int, last: int, seed: int, seconds: float) -> Outcome:
        """Try starts; see `Method.run`."""
        best = np.empty((self._sizes[0], 3))
        return Outcome(
            best,
            *search(
                *self._tables,
                rows,
                *self._scalars,
                given,
                first,
                last,
                seed,
                ITERATIONS,
                seconds,
                self._workspace(len(rows)),
                best,
            ),
        )

    def _workspace(self, targets: int) -> Floats:
        workspace: Floats | None = getattr(self._local, "workspace", None)
        size = workspace_size(*self._sizes, targets)
        if workspace is None or len(workspace) < size:
            workspace = self._local.workspace = np.empty(size)
        return workspace
