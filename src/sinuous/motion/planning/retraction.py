"""Retraction out of narrow places: a body is drawn back along itself.

The tip goes back along the curve that the body makes, and the body slides back with it, the more the nearer it is to
the tip; the rest gives way as little as it can, pushed off by obstacles. A robot that cannot stretch bends more,
outside. Backwards, it is the motion into the place.
"""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.motion.configurations import within_limits
from sinuous.motion.planning.local_planner import CLEARANCES, LocalPlanner
from sinuous.problem.target import Target
from sinuous.solver.polylines import lengths_along

SHORTEST, LONGEST = 0.05, 0.4
"""Steps of the tip, in segments: twice as long after one that succeeds, half as long after one that does not."""

ENOUGH = 0.15
"""What is left in front of the tip of a body that is drawn back altogether, in robot lengths."""

BEFORE = 0.5
"""What is as near before the tip of the other end slides, too, in segments."""

MOST_STEPS = 100_000
"""Steps of one retraction."""

OF_CURVE = 20
"""Points of the curve on each segment."""


KINDS = (True, False)
"""Kinds of retractions: whether only what is beyond the tip of the other end slides, and the rest goes to where it is
there; or all slides."""

WAYS = len(KINDS) * (len(CLEARANCES) + 1)
"""Kinds, each with every room: what is tried first, and, where that is stuck, what goes on from there."""

DAMPING = 1e-3
"""Of the motion with which a body slides back, as a share of the mean diagonal entry of its normal matrix."""

VELOCITY_BY_ROTATION = np.cross(np.eye(3)[:, None], np.eye(3)).transpose(1, 2, 0).reshape(3, 9)
"""Times an arm (3,): the matrix (3, 3), flat, that makes of a rate of rotation the velocity of the end of the arm."""


class Retraction:
    """The knots of a body that is drawn back along itself, as far as that goes.

    Parameters
    ----------
    local : LocalPlanner
    q : ndarray (n, 3)
        Where it begins: within all limits and clear.
    kind : int
        With which of the `KINDS` it begins.
    other : ndarray (n, 3)
        The other end of the path. The place of the curve beside its tip is where kinds that meet it are with the tip
        when the rest of the body is as it is there.

    Attributes
    ----------
    knots : list of ndarray (n, 3)
        The motion from each to the next is proved clear.
    left : float
        What is left of the curve in front of the tip (length unit).
    """

    def __init__(self, local: LocalPlanner, q: Floats, kind: int, other: Floats) -> None:
        self._local, self._way, self._first = local, 0, kind
        self._points = local.robot.backbone(q, OF_CURVE)
        self._along = lengths_along(self._points)
        self._other = other
        apart = np.linalg.norm(self._points - local.robot.tip(other)[:3, 3], axis=1)
        self._beside = float(self._along[apart.argmin()])
        self._segment = local.robot.mean_length / len(q)
        self._step, self._stuck = SHORTEST * self._segment, 0
        self.left = float(self._along[-1])
        self.knots = [q]
        self._rates: dict[bool, Floats] = {}

    def run(self, steps: int = MOST_STEPS, ways: int = WAYS) -> bool:
        """Draw the body back by so many steps, also such as fail, while there is time; say whether it is done.

        It stops where so many `ways`, one after the other, lead no further.
        """
        enough = ENOUGH * self._local.robot.mean_length
        for _ in range(steps):
            if self.left <= enough or self._stuck == WAYS or self._local.deadline.left() <= 0.0:
                return True
            if self._stuck == ways:
                break
            if self._goes_to(max(0.0, self.left - self._step)):
                self._step, self._stuck = min(2.0 * self._step, LONGEST * self._segment), 0
            elif self._step >= 2.0 * SHORTEST * self._segment:
                self._step *= 0.5
            else:
                self._way, self._stuck = (self._way + 1) % WAYS, self._stuck + 1
                self._step = SHORTEST * self._segment
        return False

    def _goes_to(self, along: float) -> bool:
        """Lead the tip to a place of the curve, if there is a proved motion."""
        local, q = self._local, self.knots[-1]
        meets = KINDS[(self._first + self._way) % len(KINDS)]
        room = (*CLEARANCES, 0.0)[self._way // len(KINDS)]
        place = np.array([np.interp(along, self._along, axis) for axis in self._points.T])
        begin = within_limits(local.robot, q + (self.left - along) * self._sliding(meets))
        new = local.lead(Target(place), begin, room)
        if new is None or not local.is_clear(q, new):
            return False
        self.knots.append(new)
        self.left = along
        self._rates.clear()
        return True

    def _sliding(self, meets: bool) -> Floats:
        """How the body slides back; of one that meets the other end, what is before that one's tip goes there instead.

        It is kept for other steps from the same knot, of which many fail.
        """
        if meets not in self._rates:
            q, robot = self.knots[-1], self._local.robot
            weights, wished = np.arange(1, len(q) + 1) / len(q), np.zeros((len(q), 3))
            if meets:
                places = self.left - np.append(np.cumsum(q[:0:-1, 2])[::-1], 0.0)
                weights[places < self._beside - BEFORE * self._segment] = 0.0
                weights[-1] = 1.0
                left = self.left - self._beside
                wished = (self._other - q) / max(left, LONGEST * self._segment) if left > 0.0 else wished
            self._rates[meets] = sliding(robot, q, weights, wished)
        return self._rates[meets]


def sliding(robot: Robot, q: Floats, weights: Floats, wished: Floats) -> Floats:
    """Return by how much a configuration (n, 3) changes where it slides back along itself by 1, to first order.

    The ends of segments go back along their tangents, as far as they can (damped least squares); each counts by its
    weight (n,). What that leaves free changes by `wished` (n, 3). The robot has no tool.
    """
    n, basis = len(q), robot.drive.coordinates.basis
    units = np.array([1.0, 1.0, robot.mean_length / n])
    ends, jacobian = robot.forward(q), robot._row_jacobian(q, n)
    arms = ends[:, :3, 3] - ends[-1, :3, 3]
    moves = jacobian[3:] + (arms @ VELOCITY_BY_ROTATION).reshape(n, 3, 3) @ jacobian[:3]  # (n, 3, 3 n), of every end
    moves *= (weights[:, None] * np.tri(n)).repeat(3, axis=1)[:, None]
    rows, hoped = (moves.reshape(3 * n, n, 3) * units).reshape(3 * n, 3 * n) @ basis, (wished / units).ravel() @ basis
    normal, off = rows.T @ rows, (weights[:, None] * ends[:, :3, 2]).ravel() + rows @ hoped
    normal.flat[:: len(normal) + 1] += DAMPING * normal.trace() / (3 * n) + np.finfo(float).tiny
    return units * (basis @ (hoped - np.linalg.solve(normal, off @ rows))).reshape(n, 3)
