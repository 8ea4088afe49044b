"""The derivative of an answer that preferences have chosen: of a minimum on what targets and limits leave.

The cost is `start |q - r|^2 / 2 + bends |u|^2 / 2`, bends in rad, lengths in mean lengths of their segment; r is the
start. With its Hessian less the curvatures of all active rows times their multipliers, L, and a basis N of the motions
that keep the rows, a motion is `dq = z - N (N' L N)^-1 N' (L z + M dtheta)`: z keeps the rows, and M is how the slope
of the Lagrangian changes with the parameters. Solves end near the minimum; Newton steps go on from there first.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np

from sinuous.answer.derivatives.parameters import RANK, DerivativePlan, Kept, KeptRows, fixed_lengths, least_motion
from sinuous.base.checks import Floats
from sinuous.kernels.derivative import layout as a
from sinuous.kernels.derivative.sides import CIRCLE, RADIUS_OF
from sinuous.kernels.packing import scales_of, turns_of
from sinuous.kernels.velocity.layout import (
    ACTUATOR_LIMIT,
    BEND_LIMIT,
    CLEARANCE_LIMIT,
    CURVATURE_LIMIT,
    SELF_CLEARANCE_LIMIT,
)
from sinuous.model.robot import Robot
from sinuous.problem.problem import Preferences, Problem

STEPS = 40
"""Most Newton steps to the minimum."""

STILL = 1e-10
"""Length of a step, in the metric of motions, that ends them."""

FARTHEST = 0.3
"""Farthest that they lead in all; a minimum farther away is another one."""

LONGEST = 0.1
"""Longest step."""

CONVEX = 0.2
"""Least curvature of the cost along any motion that steps count with; where there is less, they are shorter."""

PUSHING = 1e-7
"""What a limit has to push, relative to the slope of the cost, to stay active whatever changes."""

DIFFERENCE = 1e-5
"""Step of the central differences of a Jacobian: rad, and mean lengths of the segment."""


class Wish(NamedTuple):
    """What chose an answer.

    Attributes
    ----------
    preferences : Preferences
    reference : ndarray (n, 3) or None
        The start that it is to stay close to; `None` where none was given.
    spare : float
        Clearance that it has beyond the one that is wished for.
    """

    preferences: Preferences
    reference: Floats | None
    spare: float

    @property
    def weighs(self) -> bool:
        """Whether it says which answer is best: not where clearance is missing, or the start is not known."""
        own = self.preferences
        known = own.start == 0.0 or self.reference is not None
        return known and own.start + own.bends > 0.0 and (own.clearance == 0.0 or self.spare > 0.0)


class Minimum(NamedTuple):
    """A minimum of the cost: its configuration (n, 3), and the motions (3 n, p) of it."""

    q: Floats
    moved: Floats


def follow_minimum(problem: Problem, q: Floats, plan: DerivativePlan, wish: Wish, rows: KeptRows) -> Minimum | None:
    """Derive the minimum near `q` (n, 3); `None` where there is no derivative, or none is found.

    `rows` are those of `q`.
    """
    begin, robot, rows = q, problem.robot, rows.at(q)
    for _ in range(STEPS):
        if not rows.smooth or np.isin(rows.about[:, a.ROW_KIND], (CLEARANCE_LIMIT, SELF_CLEARANCE_LIMIT)).any():
            return None  # how contacts curve is not known
        q = rows.q
        system = _System(problem, q, wish, rows)
        step = system.step()
        if np.linalg.norm(step) < STILL:
            if not system.pushes or robot.excess(q) > 1e-6 * robot.mean_length:
                return None
            direct = fixed_lengths(plan)
            moved = system.motion(rows.sides - rows.rows @ direct, system.mixed(plan))
            return None if moved is None else Minimum(q, system.turns @ (system.scale[:, None] * moved) + direct)
        share = min(1.0, LONGEST / float(np.linalg.norm(step)))
        q = q + share * (system.turns @ (system.scale * step)).reshape(q.shape)
        if not _is_near(q, begin, wish, robot):  # nor where the step is NaN
            return None
        rows = rows.at(q)
    return None


def _is_near(q: Floats, begin: Floats, wish: Wish, robot: Robot) -> bool:
    """Whether Newton steps have not led to elsewhere, nor to where clearance is missing."""
    way = np.abs(q - begin)
    reach = float(way[:, :2].sum() * q[:, 2].sum() + way[:, 2].sum())
    clear = wish.preferences.clearance == 0.0 or reach < wish.spare
    scales = scales_of(robot.limits)[:, 2]
    way[:, 2] /= np.where(scales > 0.0, scales, 1.0)
    return clear and float(np.linalg.norm(way)) < FARTHEST


class _System:
    """The conditions of a minimum at a configuration, in the metric of motions; what cannot move has scale 0."""

    def __init__(self, problem: Problem, q: Floats, wish: Wish, rows: KeptRows) -> None:
        self._problem, self._q, self._wish, self._rows = problem, q, wish, rows
        self.scale, self.turns = scales_of(problem.robot.limits).ravel(), turns_of(problem.robot.limits)
        moves = self.scale.reshape(q.shape)[:, [0, 0, 2]] > 0.0
        weight = np.where(moves, wish.preferences.start, 0.0)
        weight[:, 2] /= np.where(self.scale[2::3] > 0.0, self.scale[2::3], 1.0) ** 2
        self._weight = weight
        bends = np.array([1.0, 1.0, 0.0]) * wish.preferences.bends
        reference = q if wish.reference is None else wish.reference
        self._pull_back = weight * (q - reference)
        slope = ((self._pull_back + bends * q).ravel() @ self.turns) * self.scale
        self._rows_scaled = (rows.rows @ self.turns) * self.scale
        forces = np.linalg.lstsq(self._rows_scaled.T, slope, rcond=RANK)[0]
        self._slope = slope
        limits = forces[rows.targets :]
        self.pushes = bool((limits > PUSHING * (1.0 + np.abs(slope).max())).all())
        self._forces = forces * rows.about[:, a.ROW_FACTOR]
        curvature = np.diag((weight + bends).ravel()) - self._of_targets() - self._of_limits()
        self._bent = self.scale[:, None] * (self.turns.T @ curvature)

    def step(self) -> Floats:
        """Step (3 n,) of Newton's method within the limits, in the metric; NaN where there is none.

        It is the minimum of a quadratic program: of the cost with the curvature of the Lagrangian.
        """
        moves, targets = self.scale > 0.0, self._rows.targets
        limits = list(self._problem.robot.limit_set.sides(self._q))
        least = -np.array([each.gradient.ravel() for each in limits]).reshape(-1, len(moves))
        least = (least @ self.turns) * self.scale
        sizes = np.linalg.norm(least, axis=1)
        kept = sizes > 0.0
        bounds = -np.array([each.slack for each in limits])[kept] / sizes[kept]
        free = self._free(targets)
        inner = (self._bent @ self.turns) * self.scale
        flattest = float(np.linalg.eigvalsh(free.T @ inner @ free).min(initial=np.inf))
        inner = (inner + max(0.0, CONVEX - flattest) * np.eye(len(moves)))[np.ix_(moves, moves)]
        program = Kept(self._rows_scaled[:targets, moves], (least[kept] / sizes[kept, None])[:, moves], inner)
        step = np.zeros(len(moves))
        step[moves] = least_motion(program, self._rows.missing[:targets], bounds, self._slope[moves])
        return step

    def motion(self, values: Floats, slopes: Floats) -> Floats | None:
        """Motions (3 n, p) that give rows these values (r, p) where the Lagrangian has more slopes (3 n, p)."""
        least = np.linalg.lstsq(self._rows_scaled, values, rcond=RANK)[0] if len(values) else np.zeros_like(slopes)
        inner, free = (self._bent @ self.turns) * self.scale, self._free(len(self._rows_scaled))
        reduced = free.T @ inner @ free
        if np.linalg.eigvalsh(reduced).min(initial=np.inf) <= PUSHING * np.abs(inner).max():
            return None
        return np.asarray(least - free @ np.linalg.solve(reduced, free.T @ (inner @ least + slopes)), np.float64)

    def _free(self, count: int) -> Floats:
        """A basis (3 n, f) of the motions that keep the first rows."""
        moves = np.flatnonzero(self.scale)
        _, sizes, directions = np.linalg.svd(self._rows_scaled[:count, moves])
        rank = int((sizes > RANK).sum())
        free = np.zeros((len(self.scale), len(moves) - rank))
        free[moves] = directions[rank:].T
        return free

    def mixed(self, plan: DerivativePlan) -> Floats:
        """How the slope of the Lagrangian (3 n, p) changes with the parameters while the configuration stays."""
        robot, rows, asked = self._problem.robot, self._rows, plan.asked
        change = np.zeros((len(self.scale), plan.columns))
        if asked[a.INITIAL] >= 0:
            change[np.arange(self._q.size), asked[a.INITIAL] + np.arange(self._q.size)] = -self._weight.ravel()
        if asked[a.LENGTHS] >= 0:  # lengths count relative to the mean of their range, which moves
            size = np.where(self.scale[2::3] > 0.0, self.scale[2::3], 1.0)
            segments = np.arange(len(robot))
            change[3 * segments + 2, asked[a.LENGTHS] + segments] = -2.0 * self._pull_back[:, 2] / size
        if asked[a.TOOL] >= 0:
            turning = robot._row_jacobian(self._q, len(robot))[:3]
            rotation = robot.forward(self._q)[-1, :3, :3]
            tangent = rotation @ robot.tool[:3, 2]
            own = slice(asked[a.TOOL], asked[a.TOOL] + 3), slice(asked[a.TOOL] + 3, asked[a.TOOL] + 6)
            for pull in self._pulls:
                if pull.end == len(robot):
                    change[:, own[0]] -= (np.cross(np.cross(rotation.T, tangent), pull.along) @ turning).T
                    change[:, own[1]] -= (np.cross(rotation.T, pull.force) @ turning).T
        for row, about, sides, force in zip(rows.rows, rows.about, rows.sides, self._forces, strict=True):
            k, kind = int(about[a.ROW_SEGMENT]), int(about[a.ROW_KIND])
            if kind == CURVATURE_LIMIT:
                change[3 * k + 2] += float(force / about[a.ROW_FACTOR] / self._q[k, 2]) * sides
            if (
                kind == ACTUATOR_LIMIT
                and asked[a.TENDONS] >= 0
                and (line := plan.lines[int(about[a.ROW_OTHER])])[CIRCLE] >= 0.0
            ):
                bends = np.where(np.arange(len(row)) % 3 < 2, row, 0.0) / about[a.ROW_FACTOR]
                change[:, asked[a.TENDONS] + int(line[CIRCLE])] -= force * bends / line[RADIUS_OF]
        return self.scale[:, None] * (self.turns.T @ change) + self._bent @ fixed_lengths(plan)

    @cached_property
    def _pulls(self) -> "list[_Pull]":
        """What all targets pull with."""
        robot, found = self._problem.robot, []
        for i, target in enumerate(self._problem.targets):
            own = np.flatnonzero(self._rows.about[: self._rows.targets, a.ROW_OTHER] == i)
            wrench = self._rows.about[own, a.ROW_WRENCH :]
            placed = np.abs(wrench[:, 3:]).max(axis=1) > 0.0
            force = self._forces[own[placed]] @ wrench[placed, 3:]
            torque = self._forces[own[~placed]] @ wrench[~placed, :3]
            end = robot.end_row(target.segment)
            along = np.zeros(3)
            if target.direction is not None:
                along, torque = np.cross(torque, self._tangents(self._q, end)), np.zeros(3)
            found.append(_Pull(end, force, torque, along))
        return found

    def _tangents(self, q: Floats, end: int) -> Floats:
        """Directions (..., 3) of ends of a segment."""
        robot = self._problem.robot
        frames = robot.forward(q)[..., end - 1, :3, :3]
        return frames @ (robot.tool[:3, 2] if end == len(robot) else np.array([0.0, 0.0, 1.0]))

    def _of_targets(self) -> Floats:
        """Curvature (3 n, 3 n) of what the targets hold, by central differences of what pulls at each coordinate."""
        robot, size = self._problem.robot, self._q.size
        steps = DIFFERENCE * np.tile([1.0, 1.0, robot.mean_length], len(robot))
        places = self._q + np.concatenate([np.diag(steps), -np.diag(steps)]).reshape(-1, *self._q.shape)
        total = np.zeros((2 * size, size))
        for pull in self._pulls:
            jacobian = robot._row_jacobian(places, pull.end)
            torque = pull.torque + np.cross(self._tangents(places, pull.end), pull.along)
            total += np.einsum("kc,kci->ki", torque, jacobian[:, :3]) + pull.force @ jacobian[:, 3:]
        change = (total[:size] - total[size:]) / (2.0 * steps[:, None])
        return 0.5 * (change + change.T)

    def _of_limits(self) -> Floats:
        """Curvature (3 n, 3 n) of active limits of bends and curvatures; all others are flat."""
        curvature = np.zeros((self._q.size, self._q.size))
        for about, force in zip(self._rows.about, self._forces, strict=True):
            if int(about[a.ROW_KIND]) in (BEND_LIMIT, CURVATURE_LIMIT):
                k = int(about[a.ROW_SEGMENT])
                bend = self._q[k, :2]
                size = float(np.hypot(*bend))
                normal = bend / size
                own = slice(3 * k, 3 * k + 2)
                curvature[own, own] -= force * (np.eye(2) - np.outer(normal, normal)) / size
        return curvature


class _Pull(NamedTuple):
    """What a target pulls with at the end of a segment (1 = first): a force (3,), a torque (3,), and `along` (3,).

    The latter pulls at the tangent of the end: its torque is `tangent x along`.
    """

    end: int
    force: Floats
    torque: Floats
    along: Floats
