"""Our own method: a damped Newton step of the whole robot in two sweeps (see `sinuous.kernels.step.sweeps`)."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import tables
from sinuous.kernels.solve.clearance import GRAZING
from sinuous.kernels.solve.preferences import prefer
from sinuous.kernels.solve.search import search, search_many
from sinuous.kernels.step.states import workspace_size
from sinuous.kernels.tables import CODE, SOLVED, Budget, Outcome
from sinuous.methods.method import LIMITS, Call, Capabilities, Compiled, Options, Prepared, as_outcomes
from sinuous.model.robot import Robot, robot_group
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot

MARGIN = 0.1
"""Clearance that an answer in contact is given, although nobody wished for it, where it costs nothing; in radii of the
thinnest part of the body that has one, beyond what is demanded."""

THIN = 0.01
"""What counts as the radius of a body that has none, in mean lengths of the robot."""

NEARLY_GRAZING = 1.2 * GRAZING * MARGIN
"""Clearance up to which an answer beside it may be in contact: what is proved is less by up to a tenth."""


def thinnest(robot: Robot) -> float:
    """Radius of the thinnest part of a body that has one."""
    return min((each for each in robot.radii if each > 0.0), default=THIN * robot.mean_length)


class PreparedNewton(Prepared):
    """The method `newton`, prepared. One problem has an entry of its own, and what is solved is then improved.

    That entry returns its record as numbers, not in an array: the quickest way out of compiled code.
    """

    def __init__(self, name: str, capabilities: Capabilities, compiled: Compiled, robot: Robot, *place: Any) -> None:
        super().__init__(name, capabilities, compiled, robot, *place)
        self._shape = self._segments, 3
        self._settings[tables.CLEARANCE_MARGIN] = 0.0 if self._preferences else MARGIN * thinnest(robot)

    def _load(self, robot: Robot, scene: Snapshot, tolerance: Tolerance) -> None:
        """Compile the entry for one problem, or load it from the cache; that for many waits for its first call."""
        nowhere = Problem.prepared(robot, (Target((0.0, 0.0, 0.0)),), scene, tolerance)
        outcome = self.run(nowhere, np.empty((0, self._segments, 3)), (0, 0, 0, 0.0))
        if self._preferences:
            outcome.q[:] = 0.0
            self._prefer(outcome, nowhere.scene, nowhere._rows, None, 0.0)

    def _scene_group(self, scene: Snapshot) -> Floats | None:
        """Nothing where there are no obstacles: entries of their own, which compile faster, look at none."""
        return scene._kernel_group if len(scene) else None

    def build(self, problem: Problem, initial: Floats, budget: Budget) -> Call:
        """Return what `run` would call; see `Prepared.build`."""
        return Call(search, self._arguments(problem, initial, budget))

    def _arguments(self, problem: Problem, initial: Floats, budget: Budget) -> tuple[Any, ...]:
        rows, best = problem._rows, np.empty(self._shape)
        group, workspace = self._scene_group(problem.scene), self._workspace(len(rows))
        return self._robot, group, self._settings, rows, initial, budget, workspace, best

    def run(self, problem: Problem, initial: Floats, budget: Budget, reference: Floats | None = None) -> Outcome:
        """Solve one problem; see `Prepared.run`."""
        arguments = self._arguments(problem, initial, budget)
        outcome = Outcome(arguments[-1], *search(*arguments))
        if self._bounded:
            outcome = self._within_tensions(outcome)
        if self._preferences and outcome.code == SOLVED and not self._preferences.satisfied(outcome.clearance):
            left = budget[3] - outcome.seconds
            return self._within_tensions(self._prefer(outcome, problem.scene, problem._rows, reference, left))
        return outcome

    def run_many(
        self,
        scene: Snapshot,
        rows: Floats,
        initial: Floats,
        budget: Budget,
        answers: Floats,
        references: Floats | None = None,
    ) -> None:
        """Solve many problems; see `Prepared.run_many`."""
        super().run_many(scene, rows, initial, budget, answers)
        if self._preferences is None:
            return
        for i in np.flatnonzero(answers[:, CODE] == SOLVED).tolist():
            outcome = as_outcomes(answers[i : i + 1])[0]
            if self._preferences.satisfied(outcome.clearance):
                continue
            reference = None if references is None else references[i]
            better = self._prefer(outcome, scene, rows[i], reference, budget[3] - outcome.seconds)
            self._within_tensions(better).write(answers[i])

    def _prefer(
        self, outcome: Outcome, scene: Snapshot, rows: Floats, reference: Floats | None, seconds: float
    ) -> Outcome:
        """Improve a solved outcome, in place, by what is preferred.

        `rows` (t, 15) are the targets; `reference` (n, 3) is what to stay
        close to; `seconds` are what the search left of the budget.
        """
        near = outcome.q.copy() if reference is None else np.array(reference)
        proved = outcome.position_error, outcome.angle_error, outcome.clearance, outcome.self_clearance, seconds
        groups = self._robot, self._scene_group(scene), self._settings, rows
        used, *better, spent = prefer(*groups, near, proved, self._workspace(len(rows)), outcome.q)
        reached: dict[str, Any] = dict(
            zip(("position_error", "angle_error", "clearance", "self_clearance"), better, strict=True)
        )
        return outcome._replace(iterations=outcome.iterations + used, seconds=outcome.seconds + spent, **reached)


@dataclass(frozen=True, repr=False)
class Newton(Options):
    """The method `newton`, which has no options."""

    method: ClassVar[str] = "newton"
    capabilities: ClassVar[Capabilities] = Capabilities(
        source="this library; docs/design.md",
        rotation=True,
        orientation_alone=True,
        several_targets=True,
        limits=LIMITS,
        obstacles=True,
        preferences=True,
        planes=True,
        routes=True,
    )

    prepared = PreparedNewton

    def compiled(self, robot: Robot, scene: Scene) -> Compiled:
        """Return the search for many problems; see `Options.compiled`."""
        sizes, own = (len(robot), len(robot.actuation), len(scene)), len(robot_group(robot))
        return Compiled(search_many, lambda targets: workspace_size(*sizes, targets) + own)
