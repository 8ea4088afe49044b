"""Inverse kinematics of a robot that gives way to its weight and payload: the drive for which the loaded body is right.

A start is solved as if nothing pulled. Then the drive `q` is corrected until the equilibrium at `q` meets the targets:
Gauss-Newton steps with the derivative of the loaded body whose arcs keep what each deviates from the even share, and
Broyden's updates of it (1965) for how they do not. What is proved is the loaded body, all arcs of it.
"""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels import tables as k
from sinuous.kernels.tables import FAILED, LATE, OUT_OF_REACH, SOLVED, Outcome
from sinuous.packing import pose_row
from sinuous.problem.problem import Problem, settings_group
from sinuous.problem.target import Target
from sinuous.robot.robot import Robot, robot_group
from sinuous.solving.least_distance import least_distance
from sinuous.statics.body import body_of
from sinuous.statics.equilibrium import longest_body
from sinuous.statics.rest import Rest, rolled, tensions_kept
from sinuous.work_time import work_time

MOST_ROUNDS = 25
"""Corrections from one start."""

ENOUGH = 0.2
"""Share of the tolerances within which corrections end."""

HALVINGS = 4

DAMPING = 1e-6
"""Of a correction, relative to the largest derivative."""

DIFFERENCE = 1e-5
"""Of a coordinate, rad or relative length, by which the body is moved to see what it does."""

LARGEST = 0.7
"""Most that a bend changes in a correction, rad; and a length, in mean lengths of a segment."""

STARTS = 1000
"""Most starts that are corrected."""


class Body:
    """What a proof of a loaded body reads: the group of a robot of arcs, of which lengths and tool change.

    Parameters
    ----------
    robot : Robot
        Under load.
    problem : Problem
        Whose tolerances hold.
    """

    def __init__(self, robot: Robot, problem: Problem) -> None:
        own = body_of(robot)
        body = longest_body(robot)
        self._group, self._count = robot_group(body), len(body)
        self._settings = settings_group(body, problem.tolerance)
        self._ends, self._last = own.ends, len(robot) - 1
        self._tool = robot.tool

    def prove(self, arcs: Floats, rolls: Floats, problem: Problem, seconds: float) -> Outcome:
        """Judge the body in this shape (N, 3): solved when it is proved to be a solution as it is."""
        from sinuous.kernels.solve.search import search  # noqa: PLC0415
        from sinuous.kernels.step.states import workspace_size  # noqa: PLC0415

        group = self._group.copy()
        rows = group[k.ROBOT_HEADER : k.ROBOT_HEADER + self._count * k.SEGMENT_WIDTH].reshape(-1, k.SEGMENT_WIDTH)
        rows[:, k.MIN_LENGTH] = rows[:, k.MAX_LENGTH] = arcs[:, 2]
        group[-k.POSE_WIDTH :] = pose_row(rolled(float(rolls[-1])) @ self._tool)[0]
        targets = problem._rows.copy()
        for row in targets:
            segment = int(row[k.TARGET_SEGMENT])
            if 0 <= segment < self._last:
                end = self._ends[segment]
                row[k.TARGET_SEGMENT] = end
                if row[k.ORIENTATION] == k.ROTATION:
                    turn = row[k.GOAL : k.GOAL + 9].reshape(3, 3) @ rolled(-float(rolls[end]))[:3, :3]
                    row[k.GOAL : k.GOAL + 9] = turn.ravel()
            else:
                row[k.TARGET_SEGMENT] = -1
        scene = problem.scene._kernel_group if len(problem.scene) else None
        best = np.empty((self._count, 3))
        space = np.empty(workspace_size(self._count, 0, len(problem.scene), len(targets)))
        given, budget = np.array(arcs[None]), (0, 0, 0, seconds)
        outcome = Outcome(best, *search(group, scene, self._settings, targets, given, budget, space, best))
        if outcome.code == SOLVED and not np.array_equal(best, arcs):
            return outcome._replace(code=FAILED)  # another body is no answer
        return outcome


def errors_of(shape: Rest, targets: tuple[Target, ...], unit: float) -> tuple[Floats, float, float]:
    """What is left of the targets (6 t,) in rad and mean lengths of the robot; largest distance, largest angle."""
    parts, off, turn = [], 0.0, 0.0
    for target in targets:
        pose = shape.pose(target.segment)
        left = np.zeros(6)
        if target.direction is not None:
            left[:3] = np.cross(pose[:3, 2], target.direction)
            angle = math.atan2(float(np.linalg.norm(left[:3])), float(pose[:3, 2] @ target.direction))
            left[:3] *= angle / max(1e-300, float(np.linalg.norm(left[:3])))
            turn = max(turn, angle)
        elif target.rotation is not None:
            relative = target.rotation @ pose[:3, :3].T
            axis = 0.5 * np.array([relative[2, 1] - relative[1, 2], relative[0, 2] - relative[2, 0], 0.0])
            axis[2] = 0.5 * (relative[1, 0] - relative[0, 1])
            angle = math.atan2(float(np.linalg.norm(axis)), 0.5 * (float(np.trace(relative)) - 1.0))
            left[:3] = axis * (angle / max(1e-300, float(np.linalg.norm(axis))))
            turn = max(turn, angle)
        if target.position is not None:
            left[3:] = (target.position - pose[:3, 3]) / unit
            off = max(off, unit * float(np.linalg.norm(left[3:])))
        parts.append(left)
    return np.concatenate(parts), off, turn


def rows_of(shape: Rest, targets: tuple[Target, ...], unit: float) -> Floats:
    """Derivative (6 t, 3 n) of what targets ask, 0 of what they do not."""
    parts = []
    for target in targets:
        rows = shape.jacobian(target.segment)
        rows[3:] *= (1.0 / unit) if target.position is not None else 0.0
        if target.direction is not None:
            tangent = shape.pose(target.segment)[:3, 2]
            rows[:3] -= np.outer(tangent, tangent @ rows[:3])
        elif target.rotation is None:
            rows[:3] = 0.0
        parts.append(rows)
    return np.concatenate(parts)


class UnderLoad:
    """Corrects drives of a robot under load.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot) -> None:
        low, high = np.array([segment.length for segment in robot.segments]).T
        self._robot, self._low, self._high = robot, low, high
        self._scale = np.stack([robot.limits[:, k.BEND_SCALE]] * 2 + [robot.limits[:, k.LENGTH_SCALE]], axis=-1)
        self._bends = np.array([segment.max_bend for segment in robot.segments])
        curvatures = np.array(robot.curvatures)
        self._straight = curvatures if np.isfinite(curvatures).any() else None
        self._over = np.where(self._scale.ravel() > 0.0, self._scale.ravel(), math.inf)
        limits = robot.drive.limits
        limited = np.isfinite(limits).any(axis=1)
        self._weights = robot.drive.jacobian[limited] if limited.any() else np.zeros((0, 3 * len(robot)))
        self._least, self._most = limits[limited].T
        self._body: Body | None = None

    def within(self, q: Floats) -> Floats:
        """Bring a drive (n, 3) within the limits of segments."""
        q = q.copy()
        length = q[:, 2] = np.minimum(np.maximum(q[:, 2], self._low), self._high)
        most = self._bends if self._straight is None else np.fmin(self._bends, self._straight * length)
        square = q[:, 0] ** 2 + q[:, 1] ** 2
        if (square > most * most).any():
            size = np.sqrt(square)
            q[:, :2] *= np.where(size > most, most / np.maximum(size, 1e-300), 1.0)[:, None]
        return q

    def correct(self, q: Floats, problem: Problem, end: float) -> tuple[Rest | None, float, float, int]:
        """Correct a drive until the loaded body meets the targets; the shape, its errors and how many rounds."""
        unit, tolerance = self._robot.mean_length, problem.tolerance
        most_off, most_turn = ENOUGH * (tolerance.position or 0.0), ENOUGH * tolerance.angle
        shape = Rest(self._robot, self.within(q))
        if shape.states is None:
            return None, math.inf, math.inf, 0
        scale = self._scale.ravel()
        errors = errors_of(shape, problem.targets, unit)
        rows, exact = rows_of(shape, problem.targets, unit) * scale, False
        for rounds in range(MOST_ROUNDS):
            left, off, turn = errors
            if (off <= most_off and turn <= most_turn) or work_time() > end:
                return shape, off, turn, rounds
            tried = self._step(shape, rows, left, problem)
            if tried is None and exact:
                return shape, off, turn, rounds
            if tried is None:
                rows, exact = self._differences(shape, left, problem), True
                continue
            before, (shape, errors) = shape, tried
            moved = (shape.q - before.q).ravel() / self._over
            rows, exact = _updated(rows, moved, left - errors[0]), False
        return shape, errors[1], errors[2], MOST_ROUNDS

    def _step(
        self, shape: Rest, rows: Floats, left: Floats, problem: Problem
    ) -> tuple[Rest, tuple[Floats, float, float]] | None:
        """Correct once, and say what is left; `None` where not even a short step brings the body nearer."""
        step = _least(rows, left)
        if len(self._weights):
            step = self._keep_actuators(shape.q, rows, step)
        step *= min(1.0, LARGEST / max(1e-300, float(np.abs(step).max())))
        size = float(left @ left)
        for _ in range(HALVINGS):
            tried = Rest(self._robot, self.within(shape.q + (step * self._scale.ravel()).reshape(-1, 3)), shape)
            if tried.states is not None:
                errors = errors_of(tried, problem.targets, self._robot.mean_length)
                if errors[0] @ errors[0] < size:
                    return tried, errors
            step = 0.4 * step
        return None

    def _keep_actuators(self, q: Floats, rows: Floats, step: Floats) -> Floats:
        """Keep a step within the limits of actuators: those that it would violate are rows of it."""
        values = self._weights @ q.ravel()
        moves = self._weights * self._scale.ravel()
        low, high = (np.minimum(0.0, self._least - values), np.maximum(0.0, self._most - values))
        ahead = moves @ step
        if (ahead >= low).all() and (ahead <= high).all():
            return step
        bounds = np.concatenate([low, -high])
        known = np.isfinite(bounds)
        square: Any = rows.T @ rows
        root = np.linalg.cholesky(square + DAMPING * max(1e-12, float(np.trace(square))) * np.eye(len(step)))
        found = least_distance(root, step, np.concatenate([moves, -moves])[known], bounds[known])
        return step if found is None else found[0]

    def _differences(self, shape: Rest, left: Floats, problem: Problem) -> Floats:
        """The derivative by differences: what the body really does, weights and tendons included."""
        columns = np.zeros((len(left), self._scale.size))
        for i, scale in enumerate(self._scale.ravel().tolist()):
            if scale > 0.0:
                q = shape.q.copy()
                q[i // 3, i % 3] += DIFFERENCE * scale
                other = Rest(self._robot, q, shape)
                if other.states is not None:
                    there, _, _ = errors_of(other, problem.targets, self._robot.mean_length)
                    columns[:, i] = (left - there) / DIFFERENCE
        return columns

    def judge(self, shape: Rest, problem: Problem, seconds: float) -> Outcome:
        """Prove the loaded body, and look at the limits of actuators; the outcome has the drive as its `q`."""
        if self._body is None:
            self._body = Body(self._robot, problem)
        outcome = self._body.prove(shape.arcs, shape.rolls, problem, max(0.0, seconds))
        robot = self._robot
        held = len(robot.drive) == 0 or (not robot.violations(shape.q) and tensions_kept(robot, shape.pulls))
        wrong = outcome.code == OUT_OF_REACH or (outcome.code == SOLVED and not held)  # of this shape alone
        code = FAILED if wrong else outcome.code
        return outcome._replace(q=shape.q.copy(), code=code)


def _updated(rows: Floats, moved: Floats, gained: Floats) -> Floats:
    """Broyden's update: rows that say what this motion has brought."""
    size = float(moved @ moved)
    return rows if size == 0.0 else rows + np.outer(gained - rows @ moved, moved) / size


def _least(rows: Floats, left: Floats) -> Floats:
    """The least step with `rows step = left`, damped."""
    square = rows @ rows.T
    damping = DAMPING * max(1e-12, float(np.trace(square)))
    result: Floats = rows.T @ np.linalg.solve(square + damping * np.eye(len(square)), left)
    return result


def given(q: Floats) -> Outcome:
    """Return a start that is given (n, 3), of which nothing is known."""
    unknown = [float(each) for each in (FAILED, 0, 1, k.GIVEN)]
    return Outcome.from_record(q, [*unknown, *[math.inf] * 4, 0.0, math.inf, 0.0])


def corrections(own: UnderLoad, problem: Problem, starts: Iterator[Outcome], seconds: float) -> Iterator[Outcome]:
    """Correct start after start until the time is over, and yield what each comes to, proved or not.

    Parameters
    ----------
    own : UnderLoad
    problem : Problem
        Of the robot under load.
    starts : iterator of Outcome
        Solutions without load.
    seconds : float
        Budget.
    """
    end = work_time() + seconds
    for count, start in enumerate(starts, 1):
        shape, off, turn, rounds = own.correct(start.q, problem, end)
        if shape is None:
            found = given(start.q)
        else:
            found = own.judge(shape, problem, end - work_time())._replace(position_error=off, angle_error=turn)
        found = found._replace(source=start.source, route=start.route)
        yield found._replace(iterations=start.iterations + rounds, starts=1)
        if count >= STARTS or work_time() >= end:
            return


def solve_under_load(own: UnderLoad, problem: Problem, starts: Iterator[Outcome], seconds: float, most: int) -> Outcome:
    """Correct starts until the first whose loaded body is proved; `most`: so many at most. See `corrections`."""
    began, best, count, iterations = work_time(), None, 0, 0
    for found in corrections(own, problem, starts, seconds):
        count, iterations = count + 1, iterations + found.iterations
        if best is None or found.code == SOLVED or found.merit < best.merit:
            best = found
        if best.code == SOLVED or count >= most:
            break
    assert best is not None
    spent = work_time() - began
    code = LATE if best.code != SOLVED and spent >= seconds else best.code
    return best._replace(code=code, iterations=iterations, starts=count, seconds=spent)
