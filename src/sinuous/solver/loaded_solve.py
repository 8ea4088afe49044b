"""Inverse kinematics of a robot that gives way to its weight and payload: the drive for which the loaded body is right.

A start is solved as if nothing pulled. Then its drive is corrected by control steps towards the targets, each with the
body in equilibrium, see `sinuous.kernels.velocity.loaded`. What is proved is the loaded body, all arcs of it.
"""

import math
import threading
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sinuous.answer.residual import residual_under_load
from sinuous.base.checks import Floats
from sinuous.base.progress import work_time
from sinuous.kernels import packing
from sinuous.kernels import tables as k
from sinuous.kernels.clock import LONGEST
from sinuous.kernels.tables import FAILED, LATE, OUT_OF_REACH, SOLVED, Outcome
from sinuous.kernels.velocity import layout as a
from sinuous.kernels.velocity import query as t
from sinuous.kernels.velocity.layout import MEET_TARGETS
from sinuous.model.limits import LIMIT_ROUNDING
from sinuous.model.robot import Robot, robot_group
from sinuous.problem.problem import Problem, settings_group
from sinuous.problem.target import Tolerance
from sinuous.scene.scene import Scene
from sinuous.solver.loaded_control_step import LoadedControlStep
from sinuous.solver.step_query import STILL, RateLimits, StepQuery
from sinuous.statics.body import body_of, rolled
from sinuous.statics.equilibrium import longest_body
from sinuous.statics.rest import Rest

PIECES = 8
"""Most times that stretches are made linear anew."""

ALIKE = 1e-6
"""Largest difference of bends (rad) and lengths of two bodies that are the same."""

MOST_ROUNDS = 25
"""Corrections from one start."""

TOLERANCE_SHARE = 0.2
"""Share of the tolerances within which corrections end."""

STARTS = 1000
"""Most starts that are corrected."""


NO_OBSTACLES = Scene([]).snapshot()
"""What is corrected is the drive alone; the body is proved clear when it meets the targets."""


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


class Correction(NamedTuple):
    """What a correction came to: the body at rest, `None` where there is none, largest errors, and how many rounds."""

    shape: Rest | None
    position_error: float
    angle_error: float
    rounds: int


class LoadCorrection:
    """Corrects drives of a robot under load, by control steps towards the targets, without rates and obstacles.

    Parameters
    ----------
    robot : Robot
    tolerance : Tolerance
        With numbers.
    """

    def __init__(self, robot: Robot, tolerance: Tolerance) -> None:
        self._robot, self._limits = robot, RateLimits(robot, None, tensions=False)
        assert tolerance.position is not None
        self._tolerance = Tolerance(TOLERANCE_SHARE * tolerance.position, TOLERANCE_SHARE * tolerance.angle)
        self._local = threading.local()
        self._body: LoadedBody | None = None

    def correct(self, q: Floats, problem: Problem) -> Correction:
        """Correct a drive until the loaded body meets targets."""
        robot, step = self._robot, self._step()
        asked = StepQuery(MEET_TARGETS, STILL, problem._rows, MOST_ROUNDS, 0.0, LONGEST)
        answer, rounds = np.zeros(t.CONFIGURATION + q.size + t.ACTIVE_WIDTH * a.most_constraints(len(q))), 0
        at, follow = step.unknown(np.array(q, order="C")), step.follow(q)
        for _ in range(PIECES):
            at = at._replace(q=step.advance(answer, asked, at, follow, self._limits, 1.0, None)[0])
            rounds += int(answer[t.ROUNDS])
            if math.isinf(answer[t.POSITION_ERROR]):
                return Correction(None, math.inf, math.inf, rounds)
            before, follow = follow, step.follow(at.q)
            apart = (follow - before) @ np.append(at.q, 1.0)
            if before is follow or np.abs(apart).max(initial=0.0) <= LIMIT_ROUNDING * robot.mean_length:
                break
        shape, errors = Rest(robot, at.q), (float(answer[t.POSITION_ERROR]), float(answer[t.ANGLE_ERROR]))
        if shape.states is None:
            return Correction(None, math.inf, math.inf, rounds)
        if np.abs(shape.states - at.states).max() > ALIKE:  # corrections have led to another equilibrium of this drive
            left = residual_under_load(problem, at.q)
            errors = left.position_error, left.angle_error
        return Correction(shape, *errors, rounds)

    def _step(self) -> LoadedControlStep:
        """What makes the steps of this thread."""
        kept: LoadedControlStep | None = getattr(self._local, "step", None)
        if kept is None:
            kept = self._local.step = LoadedControlStep(self._robot, NO_OBSTACLES, self._tolerance, False)
        return kept

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
    corrected = own.correct(start.q, problem)
    if corrected.shape is None:
        found = unsolved_start(start.q)
    else:
        found = own.judge(corrected.shape, problem, seconds)
        found = found._replace(position_error=corrected.position_error, angle_error=corrected.angle_error)
    iterations = start.iterations + corrected.rounds
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
