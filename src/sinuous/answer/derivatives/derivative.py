"""The derivative of an answer: how its configuration, its actuators, its tip and its clearance change."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from sinuous.answer.derivatives.parameters import (
    DerivativePlan,
    Kept,
    KeptRows,
    circles_of,
    fixed_lengths,
    least_motion,
    plan_for,
    read_wrt,
)
from sinuous.answer.derivatives.preferred import Wish, follow_minimum
from sinuous.answer.step import Active
from sinuous.base import checks
from sinuous.base.arguments import Parameter, Rows, Vector
from sinuous.base.checks import Floats
from sinuous.base.frozen import call
from sinuous.base.parameter_groups import PerGroup, check_asked, read_tangent
from sinuous.kernels.derivative import layout as a
from sinuous.kernels.packing import scales_of, turns_of
from sinuous.model.elastic import Elastic
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem

SAME_GAP = 1e-6
"""Difference of gaps, in mean lengths of the robot, up to which two places are both the nearest to obstacles."""

SAMPLES = 16
"""Places of a segment that are looked at for a bound of the clearance."""


class Derivative:
    """How an answer changes with what it depends on, to first order.

    Of all configurations near the answer that meet the changed targets, within the limits and clear of obstacles and of
    the body itself, the nearest one is meant: that which a solve from the answer finds, and `Solver.step` as its time
    goes to 0. Motion counts in rad, and in mean lengths of the segments.

    Attributes
    ----------
    wrt : tuple of str
        Groups of parameters, as in `sinuous.answer.derivatives.parameters`.
    regular : bool
        Whether there is a derivative. There is none at a singular shape, and none at a kink: an active limit or contact
        is in the way of some changes, and not of the opposite ones. The arrays below then keep whatever is active as it
        is, and `one_sided` and `jvp` tell what happens in a direction. Nor is an answer regular that was moved out of
        contact, nor one of a robot that gravity bends: its derivatives are those of the nearest answer without load. Of
        an answer that preferences have chosen the minimum near it is meant; it is not regular where there is none,
        where the body touches something or has less clearance than is wished for, or where `start` counts and none was
        given.
    singular : bool
        Whether the rows of the targets depend on each other: not every small change of the targets can be followed.
    active : tuple of Active
        Limits, obstacles and pairs of segments of which nothing is left.
    weak : tuple of Active
        Those of them that push nothing, and that a change in one direction lets go of.
    q : mapping of str to ndarray (n, 3, p)
        Derivatives of the configuration by a group of p parameters.
    tip : mapping of str to ndarray (6, p)
        Twists of the tool: angular velocity, and velocity of its origin, in world axes.
    actuators : mapping of str to ndarray (m, p)
        Derivatives of the values of all actuators.
    clearance : mapping of str to ndarray (p,), or None
        Derivatives of the least distance between body and obstacles, NaN where several places are the nearest; `None`
        without obstacles.
    """

    __slots__ = ("_clearance", "_configuration", "_plan", "_problem", "_rows")

    def __init__(self, q: Floats, rows: KeptRows) -> None:
        self._problem, self._configuration, self._plan, self._rows = rows.problem, q, rows.plan, rows

    @property
    def configuration(self) -> Floats:
        """The configuration (n, 3) that was derived: the answer, or the minimum that preferences have near it."""
        return self._configuration

    @property
    def wrt(self) -> tuple[Parameter, ...]:
        """Groups of parameters."""
        return self._plan.wrt

    @property
    def regular(self) -> bool:
        """Whether there is a derivative."""
        return bool(self._rows.answer[a.STATUS] == 0.0)

    @property
    def singular(self) -> bool:
        """Whether not every small change of the targets can be followed."""
        return bool(int(self._rows.answer[a.STATUS]) & a.SINGULAR)

    @property
    def active(self) -> tuple[Active, ...]:
        """What nothing is left of; once for each limit, each obstacle and segment, each pair of segments."""
        limited = [self._problem.robot.actuators[i] for i in self._plan.limited]
        rows = (
            self._rows.about[self._rows.targets :, [a.ROW_KIND, a.ROW_SEGMENT, a.ROW_OTHER]].astype(np.int64).tolist()
        )
        return tuple(dict.fromkeys(Active.of(row, self._problem.robot, self._problem.scene, limited) for row in rows))

    @property
    def weak(self) -> tuple[Active, ...]:
        """Those that push nothing."""
        return () if self.regular else self.active

    @property
    def q(self) -> Mapping[Parameter, Floats]:
        """Derivatives (n, 3, p) of the configuration."""
        return PerGroup(self.wrt, self._of_q)

    @property
    def tip(self) -> Mapping[Parameter, Floats]:
        """Twists (6, p) of the tool."""
        return PerGroup(self.wrt, partial(tip_twist, self._problem, self._configuration, self.q))

    @property
    def actuators(self) -> Mapping[Parameter, Floats]:
        """Derivatives (m, p) of the values of all actuators."""
        return PerGroup(self.wrt, partial(actuator_change, self._problem.robot, self._configuration, self.q))

    @property
    def clearance(self) -> Mapping[Parameter, Floats] | None:
        """Derivatives (p,) of the least distance between body and obstacles."""
        if not len(self._problem.scene):
            return None
        if not hasattr(self, "_clearance"):
            self._clearance = clearance_change(self._problem, self._configuration, self._plan, self._rows.moved)
        return PerGroup(self.wrt, lambda name: self._clearance[self._plan.chosen(name, self._problem)])

    def labels(self, name: Parameter) -> tuple[str, ...]:
        """What the columns of a group are called: `target.position_x`, `s1.length`, `pillar.v_x`."""
        check_asked(name, self.wrt)
        return self._plan.labels(name, self._problem)

    def vjp(self, cotangent: Rows) -> dict[Parameter, Floats]:
        """Derivatives (p,) of `sum(cotangent * q)` by each group, for a cotangent (n, 3).

        Raises
        ------
        InputError
            When it has another shape.
        """
        given = checks.array("cotangent", cotangent, self._configuration.shape).ravel() @ self._rows.moved
        return {name: given[self._plan.chosen(name, self._problem)] for name in self.wrt}

    def jvp(self, tangent: Vector | Mapping[Parameter, Vector]) -> Floats:
        """Motion (n, 3) of the configuration when the parameters begin to move along `tangent`.

        At a kink it is that of this direction. NaN where no configuration follows.

        Parameters
        ----------
        tangent : array_like (p,), or mapping of str to array_like (p,)
            Of the one group that was asked for, or of some by their names; others stay.

        Raises
        ------
        InputError
            When a name was not asked for, or a tangent has another shape.
        """
        whole = self._tangent(tangent)
        moved = self._rows.moved @ whole if self.regular else self._one_way(whole)
        return moved.reshape(self._configuration.shape)

    def one_sided(self, name: Parameter) -> tuple[Floats, Floats]:
        """Derivatives (n, 3, p) by the parameters of a group from below and from above; equal where it is regular.

        NaN where no configuration follows a parameter to that side.
        """
        shape = *self._configuration.shape, -1
        if self.regular:
            return self.q[name], self.q[name]
        check_asked(name, self.wrt)
        columns = np.arange(self._plan.columns)[self._plan.chosen(name, self._problem)]
        units = [np.where(np.arange(self._plan.columns) == column, 1.0, 0.0) for column in columns]
        empty = np.empty((self._configuration.size, 0))
        sides = [[sign * self._one_way(sign * unit) for unit in units] for sign in (-1.0, 1.0)]
        below, above = (np.column_stack([empty, *side]).reshape(shape) for side in sides)
        return below, above

    def __repr__(self) -> str:
        told = "regular" if self.regular else "singular" if self.singular else "kink"
        held = [f"active {', '.join(dict.fromkeys(each.constraint for each in self.active))}"] if self.active else []
        return call("Derivative", [", ".join(self.wrt), told, *held])

    def _of_q(self, name: Parameter) -> Floats:
        chosen = self._rows.moved[:, self._plan.chosen(name, self._problem)]
        return checks.closed(chosen.reshape(*self._configuration.shape, chosen.shape[1]))

    def _tangent(self, tangent: Any) -> Floats:
        whole = np.zeros(self._plan.columns)
        for name, value in read_tangent(tangent, self.wrt).items():
            count = len(self.labels(name))
            whole[self._plan.chosen(name, self._problem)] = checks.array(f"tangent[{name!r}]", value, (count,))
        return whole

    def _one_way(self, tangent: Floats) -> Floats:
        """Motion (3 n,) where parameters begin to move along `tangent` (p,): what is active only pushes."""
        rows, targets, limits = self._rows.rows, self._rows.targets, self._problem.robot.limits
        scale, turns = scales_of(limits).ravel(), turns_of(limits)
        moves = scale > 0.0
        direct = direct_motion(self._plan) @ tangent
        values = self._rows.sides @ tangent - rows @ direct
        scaled = (rows @ turns)[:, moves] * scale[moves]
        kept = Kept(scaled[:targets], scaled[targets:], None)
        least = least_motion(kept, values[:targets], values[targets:], np.zeros(len(scaled.T)))
        if np.isnan(least).any():
            return np.full(len(scale), np.nan)
        moved: Floats = direct.copy()
        moved += turns[:, moves] @ (scale[moves] * least)
        return moved


def derivative_of(
    problem: Problem, q: Floats, wrt: Parameter | Sequence[Parameter], liked: bool = False, wish: Wish | None = None
) -> Derivative:
    """Derive an answer `q` (n, 3) by groups of parameters; `liked`: it was not chosen as the nearest, but by `wish`."""
    plan = plan_for(problem, read_wrt(wrt))
    rows = KeptRows.found(problem, plan, q)
    if liked:
        least = follow_minimum(problem, q, plan, wish, rows) if wish is not None and wish.weighs else None
        if least is None:
            rows.answer[a.STATUS] += a.PREFERRED
        else:
            q, rows = least.q, rows.at(least.q)
            rows.moved[:], rows.answer[a.STATUS] = least.moved, 0.0
    if plan.elastic is not None and _is_taut(plan.elastic, q, problem.robot):
        rows.answer[a.STATUS] = float(int(rows.answer[a.STATUS]) | a.KINK)
    return Derivative(q, rows)


def _is_taut(elastic: Elastic, q: Floats, robot: Robot) -> bool:
    """Whether nothing is left of what the limits of elastic actuators allow, which kernels do not know."""
    return bool(elastic.balance(q).short.max(initial=-np.inf) > -SAME_GAP * robot.mean_length)


def direct_motion(plan: DerivativePlan) -> Floats:
    """What parameters move by themselves (3 n, p)."""
    direct = fixed_lengths(plan)
    if plan.asked[a.INITIAL] >= 0:
        basis, first = plan.robot.drive.coordinates.basis, plan.asked[a.INITIAL]
        direct[:, first : first + len(basis)] += basis @ basis.T
    return direct


def tip_twist(problem: Problem, q: Floats, changes: Mapping[Parameter, Floats], name: Parameter) -> Floats:
    """Twist (6, p) of the tool for a group of parameters, where that of the configuration is among `changes`."""
    robot = problem.robot
    twist: Floats = robot._row_jacobian(q, len(robot)) @ _flat(changes[name])
    if name == "base":
        arm = robot.tip(q)[:3, 3] - robot.base[:3, 3]
        twist[:3, :3] += np.eye(3)
        twist[3:, 3:] += np.eye(3)
        twist[3:, :3] += np.cross(np.eye(3), arm).T
    elif name == "tool":
        tip = robot.forward(q)[-1, :3, :3]
        twist[:3, :3] += tip
        twist[3:, 3:] += tip
    return twist


def _flat(change: Floats) -> Floats:
    """Derivatives (n, 3, p) as a matrix (3 n, p)."""
    return change.reshape(3 * len(change), change.shape[-1])


def actuator_change(robot: Robot, q: Floats, changes: Mapping[Parameter, Floats], name: Parameter) -> Floats:
    """Derivatives (m, p) of the values of all actuators by a group of parameters."""
    drive, ways = robot.drive, np.moveaxis(changes[name], -1, 0)
    change = drive.speeds(ways, q).T
    if name == "tendons":
        for i, (kind, k, radius) in enumerate(circles_of(robot)):
            for j, actuator in enumerate(robot.actuators):
                if f"{actuator.kind}s" == kind and robot.end_row(actuator.segment) == k + 1:
                    bends = drive.jacobian[j].reshape(-1, 3)[:, :2]
                    change[j, i] += actuator.gain * float((bends * q[:, :2]).sum()) / radius
    return change


def clearance_change(problem: Problem, q: Floats, plan: DerivativePlan, moved: Floats) -> Floats:
    """Derivatives (p,) of the least distance between body and obstacles; NaN where several places are the nearest."""
    robot = problem.robot
    points = robot.backbone(q, SAMPLES)
    radii = np.repeat(robot.radii, SAMPLES)
    along = np.concatenate([[0.0], np.cumsum(np.repeat(q[:, 2] / SAMPLES, SAMPLES))])
    free = along >= robot.mount
    own = np.concatenate([radii[:1], radii])
    if not free.any():
        return np.full(plan.columns, np.nan)
    bound = float((problem.scene.distance(points[free]) - own[free]).min())
    found = KeptRows.found(problem, plan, q, bound + SAME_GAP * robot.mean_length)
    if not len(found.rows):
        return np.full(plan.columns, np.nan)
    left = found.about[:, a.ROW_SLACK]
    near = left - left.min() <= SAME_GAP * robot.mean_length
    changes = (found.rows[near] @ moved - found.sides[near]) / found.about[near, a.ROW_FACTOR][:, None]
    alike = np.ptp(changes, axis=0) <= SAME_GAP * (1.0 + np.abs(changes).max(axis=0))
    return np.where(alike, changes[0], np.nan)
