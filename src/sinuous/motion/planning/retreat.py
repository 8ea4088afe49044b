"""A body drawn back along itself, out of a narrow place: the way in, backwards, had its tip led it there.

The tip goes back along the curve that the body makes, and the body slides back with it, the more the nearer it is to
the tip; the rest gives way as little as it can, pushed off by obstacles. A robot that cannot stretch bends more,
outside.
"""

from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.configurations import movable, within_limits
from sinuous.motion.planning.means import ROOMS, Means
from sinuous.problem.target import Target
from sinuous.robot.robot import Robot
from sinuous.solving.polylines import lengths_along, points_at

FIRST, LONGEST, SHORTEST = 0.01, 0.05, 1e-3
"""Steps of the tip, in robot lengths: twice as long after one that succeeds, half as long after one that does not."""

ENOUGH = 0.02
"""What is left in front of the tip of a body that is drawn back altogether, in robot lengths."""

BEFORE = 0.5
"""What is as near before the tip of the other end slides, too, in segments."""

MOST_STEPS = 100_000

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
    meets : bool
        Whether only what is beyond the tip of the other end slides, and the rest goes to where it is there.
    """

    slides: bool
    points: bool
    meets: bool = False


KINDS = (
    Kind(True, False, True),
    Kind(True, False),
    Kind(True, True, True),
    Kind(True, True),
    Kind(False, False),
    Kind(False, True),
)
"""What is tried first, and, where that is stuck, what goes on from there: all of them with most room, then with less.
"""

WAYS = len(KINDS) * (len(ROOMS) + 1)
"""Kinds, each with every room."""


class Retreat:
    """The knots of a body that is drawn back along itself, as far as that goes.

    Parameters
    ----------
    means : Means
    q : ndarray (n, 3)
        Where it begins: within all limits and clear.
    kind : int
        With which of the `KINDS` it begins.
    other : ndarray (n, 3)
        The other end of the way. The place of the curve beside its tip is where kinds that meet it are with the tip
        when the rest of the body is as it is there.

    Attributes
    ----------
    knots : list of ndarray (n, 3)
        The motion from each to the next is proved clear.
    left : float
        What is left of the curve in front of the tip.
    """

    def __init__(self, means: Means, q: Floats, kind: int, other: Floats) -> None:
        self._means, self._way, self._first = means, 0, kind
        self._points = means.robot.backbone(q, OF_CURVE)
        self._along = lengths_along(self._points)
        self._other = other
        apart = np.linalg.norm(self._points - means.robot.tip(other)[:3, 3], axis=1)
        self._beside = float(self._along[apart.argmin()])
        self._step, self._stuck = FIRST * means.robot.mean_length, 0
        self.left = float(self._along[-1])
        self.knots = [q]

    def run(self, steps: int = MOST_STEPS) -> bool:
        """Draw the body back by so many more steps, also such as fail, while there is time; say whether it is done."""
        unit = self._means.robot.mean_length
        for _ in range(steps):
            if self.left <= ENOUGH * unit or self._stuck == WAYS or self._means.watch.seconds_left() <= 0.0:
                return True
            if self._goes_to(max(0.0, self.left - self._step)):
                self._step, self._stuck = min(2.0 * self._step, LONGEST * unit), 0
            elif self._step > SHORTEST * unit:
                self._step *= 0.5
            else:
                self._way, self._step, self._stuck = (self._way + 1) % WAYS, FIRST * unit, self._stuck + 1
        return False

    def _goes_to(self, along: float) -> bool:
        """Lead the tip to a place of the curve, if there is a proved motion."""
        means, q = self._means, self.knots[-1]
        kind = KINDS[(self._first + self._way) % len(KINDS)]
        room = (*ROOMS, 0.0)[self._way // len(KINDS)]
        begin = self._slid_back(self.left - along, kind.meets) if kind.slides else q
        new = means.lead(self._target(along, kind), begin, room)
        if new is None or not means.is_clear(q, new):
            return False
        self.knots.append(new)
        self.left = along
        return True

    def _slid_back(self, by: float, meets: bool) -> Floats:
        """The body, slid back; of one that meets the other end, what is before that one's tip goes there instead."""
        q, robot = self.knots[-1], self._means.robot
        n, weights = len(q), np.arange(1, len(q) + 1) / len(q)
        if not meets:
            return slid_back(robot, q, by, weights, np.zeros((n, 3)))
        places = self.left - np.append(np.cumsum(q[:0:-1, 2])[::-1], 0.0)
        weights[places < self._beside - BEFORE * robot.mean_length / n] = 0.0
        weights[-1] = 1.0
        left = self.left - self._beside
        share = min(1.0, by / left) if left > 0.0 else 0.0
        return slid_back(robot, q, by, weights, share * (self._other - q))

    def _target(self, along: float, kind: Kind) -> Target:
        place = points_at(self._points, self._along, np.array([along]))[0]
        if not kind.points:
            return Target(place)
        i = int(np.clip(np.searchsorted(self._along, along), 1, len(self._along) - 1))
        return Target(place, direction=self._points[i] - self._points[i - 1])


def slid_back(robot: Robot, q: Floats, by: float, weights: Floats, pull: Floats) -> Floats:
    """Return the configuration (n, 3) whose ends of segments have gone back along their tangents, as far as they can.

    To first order, within the limits of segments, by damped least squares; each end counts by its weight (n,). What
    that leaves free changes by `pull` (n, 3).
    """
    n, unit = len(robot), robot.mean_length
    scale = np.tile([1.0, 1.0, unit / n], n) * movable(robot.segments)
    ends = robot.forward(q)[-n:]
    seen = (weights[:, None, None] * _moved_ends(robot, q, ends[:, :3, 3])).reshape(3 * n, 3 * n) * (scale / unit)
    asked = (-by / unit * weights[:, None] * ends[:, :3, 2]).ravel()
    normal = seen.T @ seen
    damping = DAMPING * np.trace(normal) / len(normal)
    normal[np.diag_indices_from(normal)] += damping
    free = np.divide(pull.ravel(), scale, out=np.zeros(3 * n), where=scale > 0.0)
    change = scale * np.linalg.solve(normal, seen.T @ asked + damping * free)
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
