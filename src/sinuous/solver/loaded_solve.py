"""Inverse kinematics of a robot that gives way to its weight and payload: the drive for which the loaded body is right.

A start is solved as if nothing pulled. Then its drive is corrected by Newton's method, whose every round has the body
in equilibrium, see `sinuous.kernels.solve.loaded`. What is proved is the loaded body, all arcs of it.
"""

import math
from collections.abc import Iterator

import numpy as np

from sinuous.answer.residual import residual_under_load
from sinuous.base.checks import Floats
from sinuous.base.progress import work_time
from sinuous.kernels import packing
from sinuous.kernels import tables as k
from sinuous.kernels.tables import FAILED, LATE, OUT_OF_REACH, SOLVED, Outcome
from sinuous.model.limits import LIMIT_ROUNDING
from sinuous.model.robot import Robot, robot_group
from sinuous.problem.problem import Problem, settings_group
from sinuous.statics.body import body_of, rolled
from sinuous.statics.equilibrium import longest_body
from sinuous.statics.rest import Rest, lines_that_follow, stretches_allowed

PIECES = 8
"""Most times that stretches are made linear anew."""

ALIKE = 1e-6
"""Largest difference of bends (rad) and lengths of two bodies that are the same."""

STARTS = 1000
"""Most starts that are corrected."""


class LoadedBody:
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
        parts = packing.robot_parts(group)
        parts.segments[:, k.MIN_LENGTH] = parts.segments[:, k.MAX_LENGTH] = arcs[:, 2]
        parts.tool[:] = packing.pose_row(rolled(float(rolls[-1])) @ self._tool)[0]
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


class LoadCorrection:
    """Corrects drives of a robot under load.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot) -> None:
        self._robot, self._body_of = robot, body_of(robot)
        self._group = packing.robot_group(robot.limits, robot.actuation, robot.base, robot.tool, robot.avoids_itself)
        limits = robot.drive.limits
        limited = np.isfinite(limits).any(axis=1)
        self._bounds = np.concatenate([robot.drive.jacobian, limits], axis=1)[limited]
        self._stretches = stretches_allowed(robot)
        self._body: LoadedBody | None = None

    def correct(self, q: Floats, problem: Problem) -> tuple[Rest | None, Floats]:
        """Correct a drive until the loaded body meets targets; the shape, and the record of `kernels.solve.loaded`."""
        from sinuous.kernels.solve.loaded import ANGLE, CORRECTION_WIDTH, OFF, ROUNDS, STABLE, correct, correction_size  # noqa: PLC0415

        robot, own = self._robot, self._body_of
        settings, q, record = (
            settings_group(robot, problem.tolerance),
            np.array(q, order="C"),
            np.zeros(CORRECTION_WIDTH),
        )
        states, lines = np.empty((len(own.owners), 4)), own.line_table.copy()
        tensions, targets = np.zeros(len(lines)), problem._rows
        buffer = np.empty(correction_size(len(q), len(states), len(lines), own.slopes, len(targets), len(self._bounds)))
        follow, rounds = lines_that_follow(robot, q), 0.0
        for _ in range(PIECES):
            of_robot = own.sections, follow, self._bounds, self._stretches
            tables = own.carried, lines, own.slopes
            correct(self._group, settings, targets, *of_robot, *tables, q, states, tensions, buffer, record)
            rounds += record[ROUNDS]
            if record[STABLE] == 0.0:
                return None, record
            before, follow = follow, lines_that_follow(robot, q)
            apart = (follow - before) @ np.append(q, 1.0)
            if not len(apart) or np.abs(apart).max() <= LIMIT_ROUNDING * robot.mean_length:
                break
        record[ROUNDS], shape = rounds, Rest(robot, q)
        if shape.states is None:
            return None, record
        if np.abs(shape.states - states).max() > ALIKE:  # corrections have led to another equilibrium of this drive
            left = residual_under_load(problem, q)
            record[OFF], record[ANGLE] = left.position_error, left.angle_error
        return shape, record

    def judge(self, shape: Rest, problem: Problem, seconds: float) -> Outcome:
        """Prove the loaded body, and look at the limits of actuators; the outcome has the drive as its `q`."""
        if self._body is None:
            self._body = LoadedBody(self._robot, problem)
        outcome = self._body.prove(shape.arcs, shape.rolls, problem, max(0.0, seconds))
        held = len(self._robot.drive) == 0 or self._robot.limit_set.keep(shape.q, shape.pulls)
        wrong = outcome.code == OUT_OF_REACH or (outcome.code == SOLVED and not held)  # of this shape alone
        code = FAILED if wrong else outcome.code
        return outcome._replace(q=shape.q.copy(), code=code)


def unsolved_start(q: Floats) -> Outcome:
    """Return a start that is given (n, 3), of which nothing is known."""
    unknown = [float(each) for each in (FAILED, 0, 1, k.GIVEN)]
    return Outcome.from_record(q, [*unknown, *[math.inf] * 4, 0.0, math.inf, 0.0])


def correct_starts(
    own: LoadCorrection, problem: Problem, starts: Iterator[Outcome], seconds: float
) -> Iterator[Outcome]:
    """Correct start after start until the time is over, and yield what each comes to, proved or not.

    Parameters
    ----------
    own : LoadCorrection
    problem : Problem
        Of the robot under load.
    starts : iterator of Outcome
        Solutions without load.
    seconds : float
        Budget.
    """
    end = work_time() + seconds
    for count, start in enumerate(starts, 1):
        yield correct_start(own, problem, start, end - work_time())
        if count >= STARTS or work_time() >= end:
            return


def correct_start(own: LoadCorrection, problem: Problem, start: Outcome, seconds: float) -> Outcome:
    """Correct one start, and say what it comes to."""
    from sinuous.kernels.solve.loaded import ANGLE, OFF, ROUNDS  # noqa: PLC0415

    shape, record = own.correct(start.q, problem)
    if shape is None:
        found = unsolved_start(start.q)
    else:
        found = own.judge(shape, problem, seconds)
        found = found._replace(position_error=float(record[OFF]), angle_error=float(record[ANGLE]))
    iterations = start.iterations + int(record[ROUNDS])
    return found._replace(source=start.source, route=start.route, iterations=iterations, starts=1)


def solve_under_load(
    own: LoadCorrection, problem: Problem, starts: Iterator[Outcome], seconds: float, most: int
) -> Outcome:
    """Correct starts until the first whose loaded body is proved; `most`: so many at most. See `correct_starts`."""
    began, best, count, iterations = work_time(), None, 0, 0
    for found in correct_starts(own, problem, starts, seconds):
        count, iterations = count + 1, iterations + found.iterations
        if best is None or found.code == SOLVED or found.merit < best.merit:
            best = found
        if best.code == SOLVED or count >= most:
            break
    assert best is not None
    if math.isinf(best.position_error):  # no start has an equilibrium: a straight body may
        best = correct_start(own, problem, unsolved_start(np.array(problem.robot.straight)), seconds)
    spent = work_time() - began
    code = LATE if best.code != SOLVED and spent >= seconds else best.code
    return best._replace(code=code, iterations=iterations, starts=count, seconds=spent)
