"""A method whose whole solve is one compiled call: its tables, a workspace a thread, and its outcomes."""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.compile import announce
from sinuous.kernels.step.states import SETTINGS
from sinuous.methods.capabilities import Capabilities
from sinuous.problem.problem import Tolerance
from sinuous.problem.target import WIDTH as TARGET_WIDTH
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Outcome

RECORD = 10
"""Numbers in the record of a search; see `sinuous.kernels.solve.judge`."""


class Compiled:
    """A prepared method, behind an entry with the arguments of `sinuous.methods.opti_path.search.search`.

    Parameters
    ----------
    name : str
    capabilities : Capabilities
    search : callable
        The entry: tables of robot and scene, settings, `extra`, then targets (m, t, 15), given (m, g, n, 3), first,
        most, seed, seconds, workspace, and what it fills: best (m, n, 3) and records (m, 10).
    size : int
        Numbers (float64) that it needs as workspace.
    extra : tuple of ndarray
        Tables of its own, writable; its options first.
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
        *extra: Floats,
    ) -> None:
        settings = {
            "mount": robot.mount,
            "unit": robot.mean_length,
            "position_tolerance": tolerance.position,
            "angle_tolerance": tolerance.angle,
        }
        # Copies: the kernels are compiled for one type of array, a writable one.
        self._robot = (
            robot.limits.copy(),
            robot.actuation.copy(),
            np.concatenate([robot.base_row, robot.tool_row]),
        )
        self._scene = scene
        self._own = (np.array([settings.get(key, 0.0) for key in SETTINGS], np.float64), *extra)
        self._name, self._capabilities, self._search = name, capabilities, search
        self._segments, self._size = len(robot), size
        self._local = threading.local()
        announce(search)
        no_target = np.zeros((0, 1, TARGET_WIDTH))
        self._run(no_target, np.empty((0, 0, len(robot), 3)), 0, 0, 0, 0.0)  # compiles, or loads from the cache

    def run(self, rows: Floats, given: Floats, first: int, last: int, seed: int, seconds: float) -> Outcome:
        """Solve for one table of targets; see `Method.run`."""
        self._capabilities.refuse_targets(self._name, rows, self._segments)
        return self._run(rows[None], given[None], first, last, seed, seconds)[0]

    def run_many(self, rows: Floats, given: Floats, first: int, last: int, seed: int, seconds: float) -> list[Outcome]:
        """Solve for many tables of targets; see `Method.run_many`."""
        for each in rows:
            self._capabilities.refuse_targets(self._name, each, self._segments)
        return self._run(rows, given, first, last, seed, seconds)

    def _run(self, rows: Floats, given: Floats, first: int, last: int, seed: int, seconds: float) -> list[Outcome]:
        best, records = np.empty((len(rows), self._segments, 3)), np.empty((len(rows), RECORD))
        self._search(
            *self._robot,
            *self._scene.tables,
            *self._own,
            rows,
            given,
            first,
            last,
            seed,
            seconds,
            self._workspace(),
            best,
            records,
        )
        return [as_outcome(q, numbers) for q, numbers in zip(best, records.tolist(), strict=True)]

    def _workspace(self) -> Floats:
        """Scratch of this thread."""
        if not hasattr(self._local, "workspace"):
            self._local.workspace = np.empty(self._size)
        workspace: Floats = self._local.workspace
        return workspace


def as_outcome(q: Floats, numbers: list[float]) -> Outcome:
    """Outcome of one record, where whole numbers and truth values are floats too."""
    code, iterations, starts, kind, off, turn, clearance, bound, merit, seconds = numbers
    return Outcome(
        q, int(code), int(iterations), int(starts), int(kind), off, turn, clearance, bool(bound), merit, seconds
    )
