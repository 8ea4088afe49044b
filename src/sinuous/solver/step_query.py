"""What a control step is asked, and the limits and rates that hold for it, as the kernel reads them."""

from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.velocity import layout as a
from sinuous.model.rates import Changes, Rates, Spread
from sinuous.model.robot import Robot
from sinuous.model.tension_rows import TensionRows

STILL: tuple[float, ...] = (0.0,) * 6
"""No twist."""

FAR = 1e6
"""A change of a row of tensions that no step makes, in the length unit."""


FREE = np.array([[-np.inf, np.inf]])
"""Bounds of a row that allows everything."""

ROUNDING = 1e-9
"""Share of a change by which rounding may exceed it."""

TIGHTER = 0.98
"""How much of what it may be a change is, where lengths make speeds of motors differ from those at the start."""


class RateLimits:
    """How far segments and actuators may move in a second or a step, as the kernel reads it.

    Parameters
    ----------
    robot : Robot
    most : Rates or Changes or None
        `None`: nothing limits how far anything moves.
    tensions : bool
        Whether limits of tensions without load count.

    Attributes
    ----------
    segments : ndarray (n, 7)
        See `BEND_CHANGE` and its neighbours in `sinuous.kernels.velocity.layout`.
    actuators : ndarray (p, 3 n + 5)
        Of those that have a limit or a rate, then rows of tensions: derivatives of their displacements, then see
        `LOWEST` and its neighbours there.
    limited : tuple of Actuator
        These; then those of `motors`; then those whose tensions have limits, one for each of the last rows.
    motors : MotorRows or None
        What makes the rows of elastic actuators that have a rate; `None` where there are none.
    tensions : TensionRows or None
        What makes the last rows; `None` where no tension is limited.
    """

    def __init__(self, robot: Robot, most: Rates | Changes | None, tensions: bool = True) -> None:
        self.most = most
        n, limits = len(robot), robot.drive.limits
        unlimited = Spread(np.full(n, np.inf), np.full(n, np.inf), np.full(len(limits), np.inf))
        own = unlimited if most is None else most.spread(robot)
        further = most.further(robot) if isinstance(most, Rates) else None
        turns = further or unlimited
        self.segments = np.zeros((n, a.STEP_RATES_WIDTH))
        self.segments[:, a.BEND_CHANGE], self.segments[:, a.LENGTH_CHANGE] = own.bend, own.length
        self.segments[:, a.BEND_SECOND], self.segments[:, a.LENGTH_SECOND] = turns.bend, turns.length
        changes, seconds = (robot.drive.motors.within(each.actuator) for each in (own, turns))
        rated = np.isfinite(changes) | np.isfinite(seconds)
        self.motors: MotorRows | None = None
        if own.limits_elastic(robot) or turns.limits_elastic(robot):
            self.motors = MotorRows(robot, changes, seconds)
            rated[self.motors.places] = False
            changes[self.motors.places] = seconds[self.motors.places] = np.inf
        listed = np.isfinite(limits).any(axis=1) | rated
        self.limited = tuple(robot.actuators[i] for i in np.flatnonzero(listed))
        self.actuators = _rows(robot.drive.jacobian[listed].reshape(-1, 3 * n), limits[listed])
        self.actuators[:, 3 * n + a.LARGEST_CHANGE] = changes[listed]
        self.actuators[:, 3 * n + a.SECOND_DIFFERENCE] = seconds[listed]
        self._of_motors = slice(len(self.actuators), None)
        if self.motors is not None:
            self.limited += tuple(robot.actuators[i] for i in self.motors.actuators)
            self._of_motors = slice(len(self.actuators), len(self.limited))
            free = np.tile(FREE, (len(self.motors.actuators), 1))
            self.actuators = np.concatenate([self.actuators, _rows(np.zeros((len(free), 3 * n)), free)])
        self.accelerates = further is not None
        self.tensions = robot.limit_set.tension_rows if tensions else None
        if self.tensions is not None:
            if not self.tensions.decoupled:
                problem = "elastic lines end at a segment that they cannot bend, and have limits"
                raise InputError("tension", problem, None, "none for control steps and changes")
            elastic = robot.drive.elastic
            assert elastic is not None
            self.limited += tuple(robot.actuators[elastic.places[i]] for i in self.tensions.lines)
            rows = self._of_tensions(self.tensions, robot.straight)
            if not self.tensions.linear:
                rows[:, [3 * n + a.LOWEST, 3 * n + a.HIGHEST]] = -np.inf, np.inf  # until `write_tensions`
            self.actuators = np.concatenate([self.actuators, rows])

    def write(self, out: Floats, dt: float) -> None:
        """Write the rows of segments and actuators for a step of `dt` s into `out`, as if nothing moved before."""
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

    def write_tensions(self, out: Floats, q: Floats, tighter: Floats) -> None:
        """Write the rows of tensions as they are near a start (n, 3), with bounds that are `tighter` (p,) than theirs.

        A bound never excludes the start. Where it would, it is wished that the row changes by as much.
        """
        assert self.tensions is not None
        n, own = len(q), self._of_tensions(self.tensions, q)
        values, columns = own[:, : 3 * n] @ q.ravel(), own[:, 3 * n :]
        columns[:, a.LOWEST] += tighter
        columns[:, a.HIGHEST] -= tighter
        below, above = columns[:, a.LOWEST] - values, values - columns[:, a.HIGHEST]
        wished = np.maximum(0.0, np.minimum(tighter, np.maximum(below, above)))
        wished[np.isfinite(self.tensions.bounds).all(axis=1)] = 0.0
        inward = np.flatnonzero(wished)
        columns[inward, a.LAST_CHANGE] = np.where(above > below, -FAR, FAR)[inward]
        columns[inward, a.SECOND_DIFFERENCE] = FAR - wished[inward]
        self._parts(out)[1][-len(own) :] = own

    def write_motors(self, out: Floats, asked: "StepQuery") -> None:
        """Write the rows of motors that a step is asked to keep."""
        if asked.motors is not None:
            self._parts(out)[1][self._of_motors] = asked.motors
        if asked.still:
            self.write_still(out)

    def write_still(self, out: Floats) -> None:
        """Let no segment move."""
        self._parts(out)[0][:, [a.BEND_CHANGE, a.LENGTH_CHANGE]] = 0.0

    @staticmethod
    def _of_tensions(tensions: TensionRows, q: Floats) -> Floats:
        """The rows of tensions (p, 3 n + 5), linear about a start (n, 3)."""
        slopes = tensions.slopes(q)
        return _rows(slopes, tensions.bounds + (slopes @ q.ravel() - tensions.values(q))[:, None])

    def _parts(self, out: Floats) -> tuple[Floats, Floats]:
        size = self.segments.size
        return out[:size].reshape(self.segments.shape), out[size:].reshape(self.actuators.shape)


class MotorRows:
    """Rows of elastic actuators that have a rate: one for each and each of its floors, see `model.motor_speeds`.

    Parameters
    ----------
    robot : Robot
    changes, seconds : ndarray (m,)
        How far displacements may go in a second, and how much more of that in the next.

    Attributes
    ----------
    places : ndarray of int (k,)
        These actuators among all.
    actuators : ndarray of int (r,)
        Which of all each row is of.
    """

    def __init__(self, robot: Robot, changes: Floats, seconds: Floats) -> None:
        elastic = robot.drive.elastic
        assert elastic is not None
        rated = np.isfinite(changes[elastic.places]) | np.isfinite(seconds[elastic.places])
        self.places = elastic.places[rated]
        self.robot, self.speeds = robot, elastic.speeds
        self.chosen = np.flatnonzero(rated[self.speeds.row_lines])
        self.actuators = elastic.places[self.speeds.row_lines[self.chosen]]
        self.changes, self.seconds = changes[self.actuators], seconds[self.actuators]
        self._slopes = self.speeds.slopes_at(robot.straight)[self.chosen]

    def slopes_at(self, q: Floats) -> Floats:
        """Derivatives (r, 3 n) at a configuration (n, 3): the same everywhere where speeds are linear."""
        return self._slopes if self.speeds.linear else self.speeds.slopes_at(q)[self.chosen]

    def counted(self, q: Floats) -> Floats:
        """Displacements with stretches (r,) of each row's actuator in a configuration (n, 3)."""
        drive = self.robot.drive
        return np.asarray((drive.displacements(q) + drive.stretch(q))[self.actuators])


class MotorBounds:
    """What a step keeps of `MotorRows`: linear where it begins, with the floors that are the highest on its way.

    Parameters
    ----------
    motors : MotorRows
    start : ndarray (n, 3)
    dt : float
    velocity : ndarray (n, 3) or None
        Of the step before.

    Attributes
    ----------
    rows : ndarray (r, 3 n + 5)
    """

    def __init__(self, motors: MotorRows, start: Floats, dt: float, velocity: Floats | None) -> None:
        self._motors, self._start, n = motors, start, start.size
        self._most, self._on = motors.changes * dt, motors.speeds.on_top(start)[motors.chosen]
        self._all = _rows(motors.slopes_at(start), np.tile(FREE, (len(self._on), 1)))
        self._all[:, n + a.LARGEST_CHANGE] = self._most
        self._accelerates = velocity is not None
        if velocity is not None:
            self._all[:, n + a.SECOND_DIFFERENCE] = self._second = motors.seconds * dt * dt
            self._began = motors.counted(start)
            self._all[:, n + a.LAST_CHANGE] = self._last = self._began - motors.counted(start - dt * velocity)

    @property
    def rows(self) -> Floats:
        """Those of floors that matter; all others have no weights."""
        return np.where(self._on[:, None], self._all, _rows(np.zeros((1, self._start.size)), FREE))

    def keep(self, end: Floats) -> bool:
        """Whether motors keep their rates all the way to `end` (n, 3); where not, rows are added, or made tighter.

        Also where they do not keep their accelerations, which are wishes, and rows can be added.
        """
        speeds, chosen = self._motors.speeds, self._motors.chosen
        most = speeds.most(self._start, end - self._start)[speeds.row_lines[chosen]]
        fast = most > self._most * (1.0 + ROUNDING)
        missed = fast
        if self._accelerates:
            second = np.abs(self._motors.counted(end) - self._began - self._last)
            missed = fast | (second > self._second * (1.0 + ROUNDING))
        if not missed.any():
            return True
        new = missed & ~self._on & speeds.on_top(end)[chosen]
        self._on |= new
        known = fast & ~np.isin(self._motors.actuators, self._motors.actuators[new])
        self._all[known, self._start.size + a.LARGEST_CHANGE] *= TIGHTER * self._most[known] / most[known]
        return not (fast.any() or new.any())


def _rows(weights: Floats, bounds: Floats) -> Floats:
    """Rows (p, 3 n + 5) of weights (p, 3 n) with bounds (p, 2), as fast as may be."""
    columns = [np.full(len(bounds), np.inf)] * a.ACTUATOR_COLUMNS
    columns[a.LOWEST], columns[a.HIGHEST] = bounds.T
    columns[a.LAST_CHANGE] = np.zeros(len(bounds))
    return np.column_stack([weights, *columns])


class StepQuery(NamedTuple):
    """What a control step is asked for.

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
    motors : ndarray (r, 3 n + 5) or None
        Rows of motors that stretch, see `MotorBounds`.
    still : bool
        Whether nothing may move.
    """

    kind: int
    motion: tuple[float, ...]
    targets: Floats
    rounds: int
    wish: float
    seconds: float
    motors: Floats | None = None
    still: bool = False
