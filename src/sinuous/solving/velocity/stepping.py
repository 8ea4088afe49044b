"""One step of a control loop: the twist, or the targets, that a user asks for."""

import math
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.arguments import Number, Rows, Vector
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.kernels.tables import FAILED, GIVEN, LATE, RATE_BOUND, SOLVED, TARGET_WIDTH, Outcome
from sinuous.kernels.velocity import query as t
from sinuous.kernels.velocity.asked import POSE, POSITION, TARGETS
from sinuous.kernels.velocity.working import ACCELERATION, LENGTH_RATE
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target, Targets, Tolerance, target_list, target_table
from sinuous.robot.rates import Changes, Rates
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Solution
from sinuous.solution.step import Step, Wanted
from sinuous.solving.options import SolveOptions
from sinuous.solving.velocity.stepper import Ask, Stepper

ROUNDS = 30
"""Most steps of a solve within changes."""

STILL: tuple[float, ...] = (0.0,) * 6
SIZES = 3, 6
"""Numbers of a velocity, and of a twist."""

NO_TARGETS: Floats = np.empty((0, TARGET_WIDTH))


class ControlLoop:
    """Steps of a control loop of one robot; safe to share between threads.

    Parameters
    ----------
    robot : Robot
    scene : Scene
        Live: every tick sees the obstacles as they are then.
    options : SolveOptions
        Of which the wished clearance counts, and the time of a tick.
    tolerance : Tolerance
        With numbers for all that is not said.
    """

    def __init__(self, robot: Robot, scene: Scene, options: SolveOptions, tolerance: Tolerance) -> None:
        self._robot, self._scene, self._options, self._tolerance = robot, scene, options, tolerance
        self._stepper = Stepper(robot, tolerance)

    def step(
        self,
        q: Solution | Step | Rows,
        twist: Vector | None = None,
        dt: Number | None = None,
        *,
        target: Targets | None = None,
        rates: Rates | None = None,
        clearance: Number | None = None,
        velocity: Rows | None = None,
    ) -> Step:
        """Make one tick; see `Solver.step`."""
        own = self._configuration(q)
        if dt is None:
            raise InputError("dt", "missing", None, "a number greater than 0")
        seconds = checks.number("dt", dt, above=0.0)
        if (twist is None) == (target is None):
            problem = "missing" if twist is None else "stands beside target"
            raise InputError("twist", problem, twist, "one of twist, target")
        if twist is None:
            kind, motion, rows = TARGETS, STILL, self._rows_of(target)
        else:
            kind, motion, rows = *read_twist(twist, seconds), NO_TARGETS
        wish = self._options.prefer.clearance if clearance is None else checks.number("clearance", clearance, low=0.0)
        boxes = self._stepper.boxes(_rates(rates))
        before = self._before(velocity, boxes.accelerates)
        scene = self._scene.snapshot()
        ask = Ask(kind, motion, rows, 1, wish, self._options.time)
        answer = self._stepper.run(scene, ask, own, (boxes, seconds, before))
        return Step(Wanted(self._robot, scene, self._tolerance, seconds, kind, motion), own, answer)

    def within(self, problem: Problem, initial: Floats, changes: Changes, seconds: float) -> Outcome:
        """The best that is reached from `initial` (n, 3) within these changes, proved clear all the way."""
        ask = Ask(TARGETS, STILL, problem._rows, ROUNDS, self._options.prefer.clearance, seconds)
        answer = self._stepper.run(problem.scene, ask, initial, (self._stepper.boxes(changes), 1.0, None))
        q = answer[t.SHAPE : t.SHAPE + initial.size].reshape(initial.shape).copy()
        off, turn = float(answer[t.POSITION_ERROR]), float(answer[t.ANGLE_ERROR])
        clearance, own = float(answer[t.CLEARANCE]), float(answer[t.SELF_CLEARANCE])
        met = _met(problem.tolerance, off, turn)
        first = t.SHAPE + initial.size + 1
        kinds = answer[first : first + t.PUSHING_WIDTH * int(answer[t.HELD]) : t.PUSHING_WIDTH]
        code = FAILED
        if met and answer[t.PROVED] and min(clearance, own) > 0.0 and not self._robot.violations(q):
            code = SOLVED
        elif answer[t.ROUNDS] == 0:
            code = LATE
        elif answer[t.PROVED] and bool(((kinds >= LENGTH_RATE) & (kinds < ACCELERATION)).any()):
            code = RATE_BOUND
        rounds, merit = int(answer[t.ROUNDS]), float(answer[t.MERIT])
        return Outcome(q, code, rounds, 1, GIVEN, off, turn, clearance, own, len(kinds) > 0, merit, 0.0)

    def _configuration(self, q: Solution | Step | Rows) -> Floats:
        return _numbers("q", q.q if isinstance(q, Solution | Step) else q, (len(self._robot), 3))

    def _rows_of(self, target: Any) -> Floats:
        targets = (target,) if isinstance(target, Target) else target_list("target", target)
        return target_table(self._robot, targets)

    def _before(self, velocity: Rows | None, accelerates: bool) -> Floats | None:
        if velocity is None:
            if accelerates:
                raise InputError("velocity", "missing", None, "that of the step before, for rates with an acceleration")
            return None
        before = _numbers("velocity", velocity, (len(self._robot), 3))
        return before if accelerates else None


def _numbers(key: str, value: Any, shape: tuple[int, int]) -> Floats:
    """Check finite numbers, and copy them: what is an array already takes a tenth of the time."""
    if type(value) is np.ndarray and value.dtype == np.float64 and value.shape == shape:
        given: Floats = np.array(value, order="C")
        if math.isfinite(given.sum()):
            return given
    return checks.array(key, value, shape).copy()


def _met(tolerance: Tolerance, off: float, turn: float) -> bool:
    assert tolerance.position is not None
    assert tolerance.angle is not None
    return off <= tolerance.position and turn <= tolerance.angle


def _rates(rates: Rates | None) -> Rates | None:
    if rates is not None and not isinstance(rates, Rates):
        raise InputError("rates", "", rates, "Rates")
    return rates


def read_twist(twist: Vector, dt: float) -> tuple[int, tuple[float, ...]]:
    """Check a twist (6,) or a velocity (3,), and return what is asked for: its kind, and the motion in `dt` seconds."""
    numbers: Any = twist.tolist() if type(twist) is np.ndarray and twist.dtype == np.float64 else twist
    plain = isinstance(numbers, tuple | list) and len(numbers) in SIZES and set(map(type, numbers)) <= {int, float}
    if not (plain and math.isfinite(sum(numbers))):  # the quick way out of what is right already
        expected = "6 finite numbers (omega, v), or 3 (v)"
        numbers = checks.array("twist", twist, (None,), expected).tolist()
        if len(numbers) not in SIZES:
            raise InputError("twist", "", twist, expected)
    kind = POSITION if len(numbers) == SIZES[0] else POSE
    return kind, (*STILL[len(numbers) :], *[dt * each for each in numbers])
