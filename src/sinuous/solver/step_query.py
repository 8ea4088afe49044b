"""What a control step is asked, and the limits and rates that hold for it, as the kernel reads them."""

from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.velocity import layout as a
from sinuous.model.rates import Changes, Rates
from sinuous.model.robot import Robot


class RateLimits:
    """How far segments and actuators may move in a second or a tick, as the kernel reads it.

    Parameters
    ----------
    robot : Robot
    most : Rates or Changes

    Attributes
    ----------
    segments : ndarray (n, 7)
        See `BEND_CHANGE` and its neighbours in `sinuous.kernels.velocity.layout`.
    actuators : ndarray (p, 3 n + 5)
        Of those that have a limit or a rate: derivatives of their displacements, then see `LEAST` and its neighbours
        there.
    limited : tuple of Actuator
        These.
    """

    def __init__(self, robot: Robot, most: Rates | Changes) -> None:
        self.most = most
        n, own = len(robot), most.spread(robot)
        further = most.acceleration if isinstance(most, Rates) else None
        turns = (further or Changes()).spread(robot)
        self.segments = np.zeros((n, a.STEP_RATES_WIDTH))
        self.segments[:, a.BEND_CHANGE], self.segments[:, a.LENGTH_CHANGE] = own.bend, own.length
        self.segments[:, a.BEND_SECOND], self.segments[:, a.LENGTH_SECOND] = turns.bend, turns.length
        limits = robot.drive.limits
        changes, seconds = (robot.drive.motors.within(each.actuator) for each in (own, turns))
        listed = np.isfinite(limits).any(axis=1) | np.isfinite(changes) | np.isfinite(seconds)
        self.limited = tuple(robot.actuators[i] for i in np.flatnonzero(listed))
        least, greatest = limits[listed].T
        columns = [np.empty(0)] * a.ACTUATOR_COLUMNS
        columns[a.LOWEST], columns[a.HIGHEST], columns[a.LAST_CHANGE] = least, greatest, np.zeros(len(least))
        columns[a.LARGEST_CHANGE], columns[a.SECOND_DIFFERENCE] = changes[listed], seconds[listed]
        self.actuators = np.column_stack([robot.drive.jacobian[listed].reshape(-1, 3 * n), *columns])
        self.accelerates = further is not None

    def write(self, out: Floats, dt: float) -> None:
        """Write the rows of segments and actuators for a tick of `dt` s into `out`, as if nothing moved before."""
        segments, actuators = self._parts(out)
        segments[:], actuators[:] = self.segments, self.actuators
        n = len(segments)
        segments[:, : a.BEND_SECOND] *= dt
        segments[:, a.BEND_SECOND : a.CHANGE_BEFORE] *= dt * dt
        actuators[:, 3 * n + a.LARGEST_CHANGE] *= dt
        actuators[:, 3 * n + a.SECOND_DIFFERENCE] *= dt * dt

    def write_before(self, out: Floats, dt: float, velocity: Floats) -> None:
        """Put in how fast everything moved before: `velocity` (n, 3)."""
        segments, actuators = self._parts(out)
        segments[:, a.CHANGE_BEFORE :] = dt * velocity
        n = len(segments)
        actuators[:, 3 * n + a.LAST_CHANGE] = dt * (self.actuators[:, : 3 * n] @ velocity.ravel())

    def _parts(self, out: Floats) -> tuple[Floats, Floats]:
        size = self.segments.size
        return out[:size].reshape(self.segments.shape), out[size:].reshape(self.actuators.shape)


class StepQuery(NamedTuple):
    """What a tick is asked for.

    Attributes
    ----------
    kind : int
        See `sinuous.kernels.velocity.layout`.
    motion : sequence of float
        Of the tip (6), rad and length unit.
    targets : ndarray (t, 15)
    rounds : int
        Most Newton steps.
    wish : float
        Clearance that is wished for.
    seconds : float
        Budget.
    """

    kind: int
    motion: tuple[float, ...]
    targets: Floats
    rounds: int
    wish: float
    seconds: float
