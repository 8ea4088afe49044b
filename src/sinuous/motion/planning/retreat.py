"""A body drawn back along itself, out of a narrow place: the way in, backwards, had its tip led it there.

The tip goes back along the curve that the body makes, and the body slides back with it, the more the nearer it is to
the tip; the rest gives way as little as it can, pushed off by obstacles. A robot that cannot stretch bends more,
outside.
"""

from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.between.query import VERDICT
from sinuous.kernels.body.proof import CLEAR
from sinuous.motion.leader.laying import movable, within_limits
from sinuous.motion.planning.question import Question
from sinuous.problem.preferences import Preferences
from sinuous.problem.target import Target
from sinuous.robot.robot import Robot
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

FINEST = 3e-4
"""Length below which the proof of a step gives up, in robot lengths: another step is tried sooner than that."""

OF_CURVE = 20
"""Points of the curve on each segment."""

DAMPING = 1e-3
"""Of the motion with which a body slides back, as a share of the mean of what it sees."""


class Kind(NamedTuple):
    """How a body is led back.

    Attributes
    ----------
    slides : bool
        Whether it begins each step by sliding back along itself, or where it is.
    points : bool
        Whether its tip points along the curve, or where it likes.
    """

    slides: bool
    points: bool


KINDS = (Kind(True, False), Kind(True, True), Kind(False, False), Kind(False, True))
"""What is tried first, and, where that is stuck, what goes on from there."""


class Means:
    """What bodies are drawn back with, made once for a question.

    Parameters
    ----------
    question : Question
    """

    def __init__(self, question: Question) -> None:
        self.watch = question.watch
        self.robot = question.robot.changed(tool=None)
        self._prover = Prover(question.robot, question.scene, FINEST)
        self._scene = question.scene

    @cached_property
    def solver(self) -> Solver:
        """Leads the tip, not the tool, from where the body is, or not at all."""
        unit = self.robot.mean_length / len(self.robot)
        options = replace(SolveOptions(), max_starts=1, routes=False, prefer=Preferences(clearance=ROOM * unit))
        with self.watch.stopped():  # compiling is no planning
            return OneSolve.prepared(self.robot, Scene.of(self._scene), options)

    def is_clear(self, p: Floats, q: Floats) -> bool:
        """Whether the motion from `p` to `q` (n, 3) is proved clear."""
        answers = self._prover.prove(np.stack([p, q]), slack=1.0, seconds=self.watch.seconds_left())
        return bool(answers[0, VERDICT] == CLEAR)


class Retreat:
    """The knots of a body that is drawn back along itself, as far as that goes.

    Parameters
    ----------
    means : Means
    q : ndarray (n, 3)
        Where it begins: within all limits and clear.
    kind : int
        With which of the `KINDS` it begins.

    Attributes
    ----------
    knots : list of ndarray (n, 3)
        The motion from each to the next is proved clear.
    """

    def __init__(self, means: Means, q: Floats, kind: int) -> None:
        self._means, self._kind = means, kind
        self._points = means.robot.backbone(q, OF_CURVE)
        steps = np.linalg.norm(np.diff(self._points, axis=0), axis=1)
        self._along = np.concatenate([[0.0], np.cumsum(steps)])
        self._left = float(self._along[-1])
        self.knots = [q]

    def run(self) -> None:
        """Draw the body back, as far as that goes, while there is time."""
        unit = self._means.robot.mean_length
        step, stuck = FIRST * unit, 0
        while self._left > ENOUGH * unit and stuck < len(KINDS) and self._means.watch.seconds_left() > 0.0:
            if self._goes_to(max(0.0, self._left - step), KINDS[self._kind]):
                step, stuck = min(2.0 * step, LONGEST * unit), 0
            elif step > SHORTEST * unit:
                step *= 0.5
            else:
                self._kind, step, stuck = (self._kind + 1) % len(KINDS), FIRST * unit, stuck + 1

    def _goes_to(self, along: float, kind: Kind) -> bool:
        """Lead the tip to a place of the curve, if there is a proved motion."""
        means, q = self._means, self.knots[-1]
        begin = slid_back(means.robot, q, self._left - along) if kind.slides else q
        target = self._target(along, kind)
        solution = means.solver.solve(target, begin, time=max(0.0, means.watch.seconds_left()))
        if not (solution.solved and means.is_clear(q, solution.q)):
            return False
        self.knots.append(np.array(solution.q))
        self._left = along
        return True

    def _target(self, along: float, kind: Kind) -> Target:
        place = [np.interp(along, self._along, axis) for axis in self._points.T]
        if not kind.points:
            return Target(place)
        i = int(np.clip(np.searchsorted(self._along, along), 1, len(self._along) - 1))
        return Target(place, direction=self._points[i] - self._points[i - 1])


def slid_back(robot: Robot, q: Floats, by: float) -> Floats:
    """Return the configuration (n, 3) whose ends of segments have gone back along their tangents, as far as they can.

    To first order, within the limits of segments, by damped least squares; an end weighs the more the nearer it is to
    the tip.
    """
    n, unit = len(robot), robot.mean_length
    scale = np.tile([1.0, 1.0, unit / n], n) * movable(robot.segments)
    ends = robot.forward(q)[-n:]
    weights = np.arange(1, n + 1) / n
    seen = (weights[:, None, None] * _moved_ends(robot, q, ends[:, :3, 3])).reshape(3 * n, 3 * n) * (scale / unit)
    asked = (-by / unit * weights[:, None] * ends[:, :3, 2]).ravel()
    normal = seen.T @ seen
    normal[np.diag_indices_from(normal)] += DAMPING * np.trace(normal) / len(normal)
    change = scale * np.linalg.solve(normal, seen.T @ asked)
    result: Floats = within_limits(robot, (q + change.reshape(n, 3))[None])[0]
    return result


def _moved_ends(robot: Robot, q: Floats, ends: Floats) -> Floats:
    """Derivatives (n, 3, 3 n) of the ends of segments (n, 3): each coordinate moves what lies beyond as one body."""
    n = len(robot)
    turn, move = np.split(robot.jacobian(q, n), 2)
    arms = ends - ends[-1]
    moved = move + np.cross(turn, arms[:, :, None], axisa=0, axisb=1, axisc=1)
    before: Floats = np.where(np.arange(n)[:, None] >= np.arange(3 * n) // 3, 1.0, 0.0)
    return np.asarray(moved * before[:, None])
