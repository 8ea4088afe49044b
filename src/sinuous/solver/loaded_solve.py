"""Inverse kinematics of a robot that gives way to its weight and payload: the drive for which the loaded body is right.

A start is solved as if nothing pulled. Then its drive is corrected by control steps towards the targets, each with the
body in equilibrium, see `sinuous.kernels.velocity.loaded`. What is proved is the loaded body, all arcs of it.
"""

import math
import threading
from collections.abc import Iterator

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.progress import work_time
from sinuous.kernels import tables as k
from sinuous.kernels.body.proof import CLEAR, UNDECIDED
from sinuous.kernels.clock import LONGEST
from sinuous.kernels.tables import FAILED, LATE, SOLVED, TARGET_BLOCKED, UNPROVED, Outcome
from sinuous.kernels.velocity import layout as a
from sinuous.kernels.velocity import query as t
from sinuous.kernels.velocity.layout import MEET_TARGETS
from sinuous.kernels.velocity.loaded import NO_BODY
from sinuous.model.limits import LIMIT_ROUNDING
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem
from sinuous.problem.target import Tolerance, meets
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.loaded_control_step import LoadedControlStep, new_answer
from sinuous.solver.step_query import STILL, RateLimits, StepQuery

PIECES = 8
"""Most times that stretches are made linear anew."""

MOST_ROUNDS = 25
"""Corrections from one start."""

TOLERANCE_SHARE = 0.2
"""Share of the tolerances within which corrections end."""

STARTS = 1000
"""Most starts that are corrected."""

NO_CONTACTS = -1.0
"""The wished clearance of steps of the drive alone: the body is proved clear where it meets the targets."""

AT_REST = [t.POSITION_ERROR, t.ANGLE_ERROR, t.CLEARANCE, t.SELF_CLEARANCE]
"""Columns of an answer, as an `Outcome` has them."""


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

    def correct(self, start: Outcome, problem: Problem, seconds: float) -> Outcome:
        """Correct the drive of a start until the loaded body meets targets, and prove that body."""
        robot, step, q = self._robot, self._step(problem.scene), np.array(start.q, order="C")
        asked = StepQuery(MEET_TARGETS, STILL, problem._rows, MOST_ROUNDS, NO_CONTACTS, LONGEST)
        answer, rounds = new_answer(q, a.most_constraints(len(q))), 0
        at, follow = step.unknown(q), step.follow(q)
        for _ in range(PIECES):
            at = at._replace(q=step.advance(answer, asked, at, follow, self._limits, 1.0, None)[0])
            rounds += int(answer[t.ROUNDS])
            before, follow = follow, step.follow(at.q)
            apart = (follow - before) @ np.append(at.q, 1.0)
            if before is follow or np.abs(apart).max(initial=0.0) <= LIMIT_ROUNDING * robot.mean_length:
                break
        tensions = step.judge(answer, asked, at, max(0.0, seconds))
        iterations = start.iterations + rounds
        if answer[t.START] == NO_BODY:
            return unsolved_start(start.q)._replace(source=start.source, route=start.route, iterations=iterations)
        off, turn, clearance, own = answer[AT_REST].tolist()
        met = meets(problem.tolerance, off, turn) and robot.limit_set.keep(at.q, tensions)
        code = {CLEAR: SOLVED, UNDECIDED: UNPROVED}.get(int(answer[t.START]), FAILED) if met else FAILED
        if code != SOLVED and start.code == TARGET_BLOCKED:  # which does not depend on loads
            code = start.code
        merit = float(answer[t.MERIT]) + (min(0.0, clearance, own) / robot.mean_length) ** 2
        found = off, turn, clearance, own, False, merit
        return Outcome(at.q, code, iterations, 1, start.source, *found, 0.0, route=start.route)

    def _step(self, scene: Snapshot) -> LoadedControlStep:
        """What makes the steps of this thread."""
        kept: LoadedControlStep | None = getattr(self._local, "step", None)
        if kept is None:
            kept = self._local.step = LoadedControlStep(self._robot, scene, self._tolerance)
        kept.move_into(scene)
        return kept


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
        yield own.correct(start, problem, end - work_time())
        if count >= STARTS or work_time() >= end:
            return


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
        best = own.correct(unsolved_start(np.array(problem.robot.straight)), problem, seconds)
    spent = work_time() - began
    code = LATE if best.code != SOLVED and spent >= seconds else best.code
    return best._replace(code=code, iterations=iterations, starts=count, seconds=spent)
