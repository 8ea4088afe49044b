"""Our own method: a damped Newton step of the whole robot in two sweeps (see `sinuous.kernels.step.sweeps`)."""

import threading

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.compile import announce
from sinuous.kernels.solve.preferences import prefer
from sinuous.kernels.solve.search import OUTCOME, SOLVED, search, search_many
from sinuous.kernels.step.states import SETTINGS, workspace_size
from sinuous.problem.problem import Preferences, Tolerance
from sinuous.problem.target import WIDTH as TARGET_WIDTH
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Outcome

ITERATIONS = 60
"""Most iterations from one start."""

COARSE, DEPTH = 0, 3
"""How often a segment is halved in the search for contacts: to compare random shapes, and in a step."""

MARGIN = 1e-4
"""Clearance that the steps aim for beyond none, of the robot's mean length: room for the proof to decide."""


class KernelTables:
    """Robot, scene and settings as the kernels read them."""

    def __init__(
        self, robot: Robot, scene: Scene, tolerance: Tolerance, preferences: Preferences | None = None
    ) -> None:
        # Copies: the kernels are compiled for one type of array, a writable one.
        self._robot = robot.limits.copy(), robot.actuation.copy(), np.concatenate([robot.base_row, robot.tool_row])
        self._scene = scene
        self._settings = _settings(robot, tolerance, preferences or Preferences())

    def now(self) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
        """What does not depend on the targets; the scene may have been updated since the last time."""
        return *self._robot, *self._scene.tables, self._settings


def _settings(robot: Robot, tolerance: Tolerance, wishes: Preferences) -> Floats:
    """In the order that `SETTINGS` says."""
    unit = robot.mean_length
    settings = {
        "mount": robot.mount,
        "unit": unit,
        "margin": MARGIN * unit,
        "position_tolerance": tolerance.position,
        "angle_tolerance": tolerance.angle,
        "coarse": COARSE,
        "depth": DEPTH,
        "iterations": ITERATIONS,
        "start": wishes.start,
        "bends": wishes.bends,
        "clearance": wishes.clearance,
    }
    return np.array([settings[key] for key in SETTINGS], np.float64)


class Newton:
    """The method `newton`, prepared: tables for the kernels, and one workspace a thread."""

    def __init__(self, robot: Robot, scene: Scene, tolerance: Tolerance, preferences: Preferences) -> None:
        self._tables = KernelTables(robot, scene, tolerance, preferences)
        self._sizes = len(robot), len(robot.actuation), len(scene)
        self._preferences = preferences
        self._local = threading.local()
        announce(search)
        nothing = np.empty((0, len(robot), 3))
        no_target = np.zeros((1, TARGET_WIDTH))
        outcome = self.run(no_target, nothing, 0, 0, 0, 0.0)  # compiles, or loads from the cache
        if preferences:
            announce(prefer)
            outcome.q[:] = 0.0
            self._prefer(outcome, no_target, nothing, 0.0, self._workspace(1))

    def run(self, rows: Floats, given: Floats, first: int, last: int, seed: int, seconds: float) -> Outcome:
        """Solve for one table of targets; see `Method.run`."""
        best = np.empty((self._sizes[0], 3))
        workspace = self._workspace(len(rows))
        outcome = Outcome(best, *search(*self._tables.now(), rows, given, first, last, seed, seconds, workspace, best))
        if self._preferences and outcome.code == SOLVED:
            return self._prefer(outcome, rows, given, seconds, workspace)
        return outcome

    def run_many(self, rows: Floats, given: Floats, first: int, last: int, seed: int, seconds: float) -> list[Outcome]:
        """Solve for many tables of targets; see `Method.run_many`."""
        announce(search_many)
        best, found = np.empty((len(rows), self._sizes[0], 3)), np.empty((len(rows), len(OUTCOME)))
        workspace = self._workspace(rows.shape[1])
        search_many(*self._tables.now(), rows, given, first, last, seed, seconds, workspace, best, found)
        outcomes = [_as_outcome(q, numbers) for q, numbers in zip(best, found.tolist(), strict=True)]
        if not self._preferences:
            return outcomes
        return [
            self._prefer(outcome, rows[i], given[i], seconds, workspace) if outcome.code == SOLVED else outcome
            for i, outcome in enumerate(outcomes)
        ]

    def _prefer(self, outcome: Outcome, rows: Floats, given: Floats, seconds: float, workspace: Floats) -> Outcome:
        """Improve a solved outcome, in place, by what is preferred."""
        reference = given[0] if len(given) else outcome.q.copy()
        proved = outcome.position_error, outcome.angle_error, outcome.clearance
        used, *better = prefer(*self._tables.now(), rows, reference, proved, seconds, workspace, outcome.q)
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


def _as_outcome(q: Floats, numbers: list[float]) -> Outcome:
    """Outcome of one row of a table, where whole numbers and truth values are floats too."""
    code, iterations, starts, kind, off, turn, clearance, bound, merit, seconds = numbers
    return Outcome(
        q, int(code), int(iterations), int(starts), int(kind), off, turn, clearance, bool(bound), merit, seconds
    )
