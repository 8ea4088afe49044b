"""What ends of plans are moved with: solvers of the robot and of thicker ones, and a proof of each step.

A solution of a thicker robot leaves the robot room. So what is too near to an obstacle for a proof, or for a tree to
leave it, is eased: it is solved again, thicker, and the step there is proved.
"""

from dataclasses import replace

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.between.query import VERDICT
from sinuous.kernels.body.proof import CLEAR
from sinuous.motion.planning.question import Question
from sinuous.problem.preferences import Preferences
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.scene import Scene
from sinuous.solving.between.steps import Prover
from sinuous.solving.options import SolveOptions
from sinuous.solving.solver import Solver
from sinuous.solving.thinner import with_radii

ROOMS = (0.2, 0.05)
"""By how much thicker robots are thicker, in radii of each segment."""

EASED = (0.4, 0.2, 0.1, 0.05, 0.02)
"""The same for easing: what has most room is tried first."""

ENOUGH = 0.1
"""What has so much room, in radii, is not eased."""

LOOSE = 0.3
"""How far the tip may move when it is eased, in the largest radius of the body."""

WISHED = 0.02
"""Clearance that is wished for by the robot as it is, in mean lengths of a segment."""

FINEST = 3e-4
"""Length below which the proof of a step gives up, in robot lengths: another step is tried sooner than that."""

CLOSE = 1e-6
"""The same of a step that eases: it may begin in contact."""


class Means:
    """What ends of plans are moved with, made once for a question.

    Parameters
    ----------
    question : Question
    """

    def __init__(self, question: Question) -> None:
        self.watch = question.watch
        self.robot = question.robot.changed(tool=None)
        self._scene = question.scene
        self._prover = Prover(question.robot, question.scene, FINEST)
        self._close_prover = Prover(question.robot, question.scene, CLOSE)
        self._solvers: dict[tuple[float, float], Solver] = {}

    def lead(self, target: Target, begin: Floats, room: float) -> Floats | None:
        """Lead the tip, not the tool, from where the body is, with so much room (radii); `None` where it cannot."""
        return self._solve(target, begin, room, 0.0)

    def eased(self, q: Floats) -> list[Floats]:
        """Return a configuration (n, 3) alone, or also one with more room that the motion to is proved clear.

        It is left alone where it has enough, and where nothing near it has any.
        """
        tip, loose = Target(self.robot.tip(q)[:3, 3]), LOOSE * max(self.robot.radii)
        enough = self._solve(tip, q, ENOUGH, loose)
        if enough is not None and np.array_equal(enough, q):
            return [q]
        for room in EASED:
            roomy = self._solve(tip, q, room, loose)
            if roomy is not None and self._clear(self._close_prover, q, roomy):
                return [q] if np.array_equal(roomy, q) else [q, roomy]
        return [q]

    def give_way(self, q: Floats, room: float) -> Floats | None:
        """Return a shape near one (n, 3) that may overlap: so much room (radii), and the tip about where it is."""
        return self._solve(Target(self.robot.tip(q)[:3, 3]), q, room, LOOSE * max(self.robot.radii))

    def is_clear(self, p: Floats, q: Floats) -> bool:
        """Whether the motion from `p` to `q` (n, 3) is proved clear."""
        return self._clear(self._prover, p, q)

    def _clear(self, prover: Prover, p: Floats, q: Floats) -> bool:
        answers = prover.prove(np.stack([p, q]), slack=1.0, seconds=self.watch.seconds_left())
        return bool(answers[0, VERDICT] == CLEAR)

    def _solve(self, target: Target, begin: Floats, room: float, loose: float) -> Floats | None:
        if (room, loose) not in self._solvers:
            with self.watch.stopped():  # compiling is no planning
                self._solvers[room, loose] = self._prepared(room, loose)
        solver = self._solvers[room, loose]
        solution = solver.solve(target, begin, time=max(0.0, self.watch.seconds_left()))
        return np.array(solution.q) if solution.solved else None

    def _prepared(self, room: float, loose: float) -> Solver:
        """A solver that goes to one target from one configuration, or not at all."""
        wished = WISHED * self.robot.mean_length / len(self.robot) if room == 0.0 else 0.0
        tolerance = Tolerance(position=loose) if loose > 0.0 else Tolerance()
        options = replace(
            SolveOptions(), max_starts=1, routes=False, prefer=Preferences(clearance=wished), tolerance=tolerance
        )
        return Solver.prepared(with_radii(self.robot, 1.0 + room), Scene.of(self._scene), options)
