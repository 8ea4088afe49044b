"""A body drawn back along itself, out of a narrow place: the way in, backwards, had its tip led it there.

The tip goes back along the curve that the body makes; the rest gives way as little as it can, pushed off by obstacles.
A robot that cannot stretch bends more, outside.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.between.query import VERDICT
from sinuous.kernels.body.proof import CLEAR
from sinuous.motion.planning.question import Question
from sinuous.problem.preferences import Preferences
from sinuous.problem.target import Target
from sinuous.scene.scene import Scene
from sinuous.solving.between import Prover
from sinuous.solving.options import SolveOptions
from sinuous.solving.solver import OneSolve, Solver

FIRST, LONGEST, SHORTEST = 0.01, 0.05, 1e-3
"""Steps of the tip, in robot lengths: twice as long after one that succeeds, half as long after one that does not."""

ENOUGH = 0.02
"""What is left in front of the tip of a body that is drawn back altogether, in robot lengths."""

ROOM = 0.02
"""Clearance that is wished for, in mean lengths of a segment: steps along obstacles are proved sooner."""

FINEST = 1e-4
"""Length below which the proof of a step gives up, in robot lengths: another step is tried sooner than that."""

OF_CURVE = 20
"""Points of the curve on each segment."""

KINDS = 2
"""Ways to lead the tip: it points where it likes, or along the curve. Where one is stuck, the other goes on."""


class Means:
    """What bodies are drawn back with, made once for a question.

    Parameters
    ----------
    question : Question
    """

    def __init__(self, question: Question) -> None:
        self.robot, self.watch = question.robot, question.watch
        self.prover = Prover(question.robot, question.scene, FINEST)
        self._scene = question.scene

    @cached_property
    def solver(self) -> Solver:
        """Leads the tip, not the tool, from where the body is, or not at all."""
        unit = self.robot.mean_length / len(self.robot)
        options = replace(SolveOptions(), max_starts=1, routes=False, prefer=Preferences(clearance=ROOM * unit))
        with self.watch.stopped():  # compiling is no planning
            return OneSolve.prepared(self.robot.changed(tool=None), Scene.of(self._scene), options)

    def is_clear(self, p: Floats, q: Floats) -> bool:
        """Whether the motion from `p` to `q` (n, 3) is proved clear."""
        answers = self.prover.prove(np.stack([p, q]), slack=1.0, seconds=self.watch.seconds_left())
        return bool(answers[0, VERDICT] == CLEAR)


class Retreat:
    """The knots of a body that is drawn back along itself, as far as that goes.

    Parameters
    ----------
    means : Means
    q : ndarray (n, 3)
        Where it begins: within all limits and clear.
    kind : int
        How the tip is led at first: 0, as it likes; 1, along the curve.

    Attributes
    ----------
    knots : list of ndarray (n, 3)
        The motion from each to the next is proved clear.
    """

    def __init__(self, means: Means, q: Floats, kind: int) -> None:
        self._means, self._kind = means, kind
        points = means.robot.backbone(q, OF_CURVE)
        self._points = points
        self._along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        self.knots = [q]

    def run(self) -> None:
        """Draw the body back, as far as that goes, while there is time."""
        unit = self._means.robot.mean_length
        left, step, stuck = float(self._along[-1]), FIRST * unit, 0
        while left > ENOUGH * unit and stuck < KINDS and self._means.watch.seconds_left() > 0.0:
            there = max(0.0, left - step)
            if self._goes_to(there):
                left, step, stuck = there, min(2.0 * step, LONGEST * unit), 0
            elif step > SHORTEST * unit:
                step *= 0.5
            else:
                self._kind, step, stuck = 1 - self._kind, FIRST * unit, stuck + 1

    def _goes_to(self, along: float) -> bool:
        """Lead the tip to a place of the curve, if there is a proved motion."""
        means = self._means
        solution = means.solver.solve(self._target(along), self.knots[-1], time=max(0.0, means.watch.seconds_left()))
        if not (solution.solved and means.is_clear(self.knots[-1], solution.q)):
            return False
        self.knots.append(np.array(solution.q))
        return True

    def _target(self, along: float) -> Target:
        place = [np.interp(along, self._along, axis) for axis in self._points.T]
        if self._kind == 0:
            return Target(place)
        i = int(np.clip(np.searchsorted(self._along, along), 1, len(self._along) - 1))
        return Target(place, direction=self._points[i] - self._points[i - 1])
