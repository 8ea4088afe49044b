"""How far segments and actuators may move in a tick, as the kernel reads it."""

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.velocity import asked as a
from sinuous.robot.rates import Changes, Rates
from sinuous.robot.robot import Robot


class Boxes:
    """How far segments and actuators may move in a second or a tick, as the kernel reads it.

    Parameters
    ----------
    robot : Robot
    most : Rates or Changes
    """

    def __init__(self, robot: Robot, most: Rates | Changes) -> None:
        self.most = most
        n, own = len(robot), most.spread(robot)
        further = most.acceleration if isinstance(most, Rates) else None
        turns = (further or Changes()).spread(robot)
        self.boxes = np.zeros((n, a.BOX_WIDTH))
        self.boxes[:, a.BEND_CHANGE], self.boxes[:, a.LENGTH_CHANGE] = own.bend, own.length
        self.boxes[:, a.BEND_TURN], self.boxes[:, a.LENGTH_TURN] = turns.bend, turns.length
        limits = robot.drive.limits
        bounded = np.isfinite(limits).any(axis=1) | np.isfinite(own.actuator) | np.isfinite(turns.actuator)
        self.listed = np.flatnonzero(bounded)
        self.lines = np.zeros((len(self.listed), 3 * n + a.LINE_WIDTH))
        if len(self.listed):
            self.lines[:, : 3 * n] = robot.drive.jacobian[self.listed]
            self.lines[:, 3 * n + a.LEAST], self.lines[:, 3 * n + a.MOST] = limits[self.listed].T
            self.lines[:, 3 * n + a.CHANGE] = own.actuator[self.listed]
            self.lines[:, 3 * n + a.TURN] = turns.actuator[self.listed]
        self.accelerates = further is not None

    def write(self, out: Floats, dt: float) -> None:
        """Write boxes and lines for a tick of `dt` seconds into `out`, as if nothing had moved before."""
        boxes, lines = self._parts(out)
        boxes[:], lines[:] = self.boxes, self.lines
        n = len(boxes)
        boxes[:, : a.BEND_TURN] *= dt
        boxes[:, a.BEND_TURN : a.BEFORE] *= dt * dt
        lines[:, 3 * n + a.CHANGE] *= dt
        lines[:, 3 * n + a.TURN] *= dt * dt

    def write_before(self, out: Floats, dt: float, velocity: Floats) -> None:
        """Put in how fast everything moved before: `velocity` (n, 3)."""
        boxes, lines = self._parts(out)
        boxes[:, a.BEFORE :] = dt * velocity
        n = len(boxes)
        lines[:, 3 * n + a.LAST] = dt * (self.lines[:, : 3 * n] @ velocity.ravel())

    def _parts(self, out: Floats) -> tuple[Floats, Floats]:
        size = self.boxes.size
        return out[:size].reshape(self.boxes.shape), out[size:].reshape(self.lines.shape)
