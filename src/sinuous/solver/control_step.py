"""Control loops: one step towards a twist or a target, and the best that is reached within given changes.

The compiled step is `sinuous.kernels.velocity.query.control_step`; here is what Python hands over to it and reads.
"""

import math
import threading
from typing import Any, NamedTuple

import numpy as np

from sinuous.answer.observer import GAIN, correct_targets, update_observer
from sinuous.answer.solution import Solution
from sinuous.answer.step import Step, WantedStep
from sinuous.base import checks
from sinuous.base.arguments import JointsAndBatch, Number, Stack, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.tables import FAILED, GIVEN, LATE, RATE_BOUND, SOLVED, TARGET_WIDTH, UNPROVED, Outcome
from sinuous.kernels.velocity import layout as a
from sinuous.kernels.velocity import query as t
from sinuous.kernels.velocity.layout import MEET_TARGETS, MOVE_POSE, MOVE_POSITION
from sinuous.model.joints import is_pair
from sinuous.model.limits import LIMIT_ROUNDING
from sinuous.model.rates import Changes, Rates
from sinuous.model.robot import Robot, robot_group
from sinuous.problem.problem import Problem, settings_group
from sinuous.problem.target import Target, Targets, Tolerance, meets, target_list, target_table
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.loaded_control_step import LoadedControlStep
from sinuous.solver.loaded_solve import unsolved_start
from sinuous.solver.options import SolveOptions
from sinuous.solver.step_query import STILL, MotorBounds, RateLimits, StepQuery
from sinuous.statics.rest import pulls_at

ROUNDS = 30
"""Most Newton steps of a solve within changes."""

TIGHTENED, TIGHTER = 6, 1.5
"""How often bounds of tensions are made tighter where a step has left them, and by how many times as much."""

RATES = a.LENGTH_RATE_LIMIT, a.BEND_RATE_LIMIT, a.ACTUATOR_RATE_LIMIT
"""Kinds of constraints that end a solve within changes with `RATE_BOUND`."""

RETRIED = 12
"""How often a step is made again on whose way a motor of an elastic actuator runs too fast."""

SIZES = 3, 6
"""Numbers of a velocity, and of a twist."""

NO_TARGETS: Floats = np.empty((0, TARGET_WIDTH))


class Scratch(NamedTuple):
    """Arrays that a thread keeps from one step to the next.

    Attributes
    ----------
    group : ndarray
        What is asked, as the kernel reads it.
    workspace : ndarray
    room : tuple of int
        Room for bounds, and for constraints of the working set.
    answer : int
        Numbers of an answer.
    """

    group: Floats
    workspace: Floats
    room: tuple[int, int]
    answer: int


class ControlLoop:
    """Steps of a control loop of one robot; safe to share between threads.

    Parameters
    ----------
    robot : Robot
    scene : Scene
        Live: every step sees the obstacles as they are then.
    options : SolveOptions
        Of which the wished clearance counts, and the time of a step.
    tolerance : Tolerance
        With numbers for all that is not said.
    """

    def __init__(self, robot: Robot, scene: Scene, options: SolveOptions, tolerance: Tolerance) -> None:
        self._robot, self._scene, self._tolerance = robot, scene, tolerance
        self._demanded = robot._least_clearances[0]
        self._wish, self._time = options.prefer.clearance, options.time
        self._group = None if robot.has_external_load else robot_group(robot)
        self._settings = settings_group(robot, tolerance)
        self._free = self._limits = RateLimits(robot, Rates())
        self._local = threading.local()

    def step(
        self,
        q: Solution | Step | JointsAndBatch,
        twist: Vector | None = None,
        dt: Number | None = None,
        *,
        target: Targets | None = None,
        rates: Rates | None = None,
        clearance: Number | None = None,
        velocity: JointsAndBatch | None = None,
        measured: Stack | None = None,
        places: Vector | None = None,
        gain: Number = GAIN,
        delay: Whole = 0,
    ) -> Step:
        """Make one step; see `Solver.step`."""
        shape = len(self._robot), 3
        given = q.configuration if isinstance(q, Solution | Step) else q
        own = _numbers("q", self._robot._one_configuration("q", given) if self._robot.joints else given, shape)
        if dt is None:
            raise InputError("dt", "missing", None, "a number greater than 0")
        seconds = checks.number("dt", dt, above=0.0)
        known, observed = q.observed if isinstance(q, Step) else None, None
        if known is not None or measured is not None:
            observed = update_observer(self._robot, own, known, measured, places, gain, delay)
        if (twist is None) == (target is None):
            problem = "missing" if twist is None else "cannot be combined with target"
            raise InputError("twist", problem, twist, "one of twist, target")
        if twist is not None:
            kind, motion, rows = *read_twist(twist, seconds), NO_TARGETS
            targets: tuple[Target, ...] = ()
        else:
            targets = target_list("target", target, self._robot)
            if observed is not None:
                targets = tuple(correct_targets(self._robot, each, observed) for each in targets)
            kind, motion, rows = MEET_TARGETS, STILL, target_table(self._robot, targets)
        wish = self._wish if clearance is None else checks.number("clearance", clearance, low=0.0)
        checks.instance("rates", rates, Rates | None, "Rates")
        limits = self._limits_of(rates)
        if velocity is None and isinstance(q, Step) and limits.accelerates:
            velocity = q.velocity
        before = (
            None
            if velocity is None
            else _numbers(
                "velocity", self._robot._one_velocity("velocity", velocity) if is_pair(velocity) else velocity, shape
            )
        )
        if limits.accelerates and before is None:
            raise InputError("velocity", "missing", None, "that of the step before, for rates with an acceleration")
        scene = self._scene.snapshot()
        asked = StepQuery(kind, motion, rows, 1, self._beyond(wish), self._time)
        moved = before if limits.accelerates else None
        answer = self._answer(scene, asked, own, limits, seconds, moved)
        limited = limits.limited if self._group is not None else (*limits.limited, *self._loaded(scene).lines)
        wanted = WantedStep(self._robot, scene, self._tolerance, seconds, kind, motion, limited)
        return Step(wanted, own, answer, observed)

    def _loaded(self, scene: Snapshot) -> LoadedControlStep:
        """What makes the steps of this thread for a robot under load."""
        kept: LoadedControlStep | None = getattr(self._local, "loaded", None)
        if kept is None:
            kept = self._local.loaded = LoadedControlStep(self._robot, scene, self._tolerance)
        kept.move_into(scene)
        return kept

    def within(self, problem: Problem, initial: Floats, changes: Changes, seconds: float) -> Outcome:
        """The best that is reached from `initial` (n, 3) within these changes, proved clear all the way."""
        asked = StepQuery(MEET_TARGETS, STILL, problem._rows, ROUNDS, self._beyond(self._wish), seconds)
        limits = self._limits_of(changes)
        answer = self._answer(problem.scene, asked, initial, limits, 1.0, None)
        if answer[t.START] < 0.0:  # no body at rest
            return unsolved_start(initial)
        q = answer[t.CONFIGURATION : t.CONFIGURATION + initial.size].reshape(initial.shape).copy()
        off, turn, clearance, own = answer[[t.POSITION_ERROR, t.ANGLE_ERROR, t.CLEARANCE, t.SELF_CLEARANCE]].tolist()
        first = t.CONFIGURATION + initial.size + 1
        kinds = answer[first : first + t.ACTIVE_WIDTH * int(answer[t.ACTIVE]) : t.ACTIVE_WIDTH]
        met, code = meets(problem.tolerance, off, turn), FAILED
        if met and min(clearance, own) > 0.0 and self._holds(q) and answer[t.START] == CLEAR:
            code = SOLVED if answer[t.PROVED] else UNPROVED
        elif answer[t.ROUNDS] == 0:
            code = LATE
        elif answer[t.PROVED] and np.isin(kinds, RATES).any():
            code = RATE_BOUND
        rounds, merit = int(answer[t.ROUNDS]), float(answer[t.MERIT])
        return Outcome(q, code, rounds, 1, GIVEN, off, turn, clearance, own, len(kinds) > 0, merit, 0.0)

    def _beyond(self, clearance: float) -> float:
        """What is wished for beyond the clearance that is demanded."""
        return max(0.0, clearance - self._demanded)

    def _limits_of(self, most: Rates | Changes | None) -> RateLimits:
        """Limits and rates as the kernel reads them; those of the last call are kept."""
        if most is None:
            return self._free
        kept = self._limits
        if kept.most is not most:
            kept = self._limits = RateLimits(self._robot, most)
        return kept

    def _holds(self, q: Floats) -> bool:
        """Whether all limits are kept, under load also those of tensions."""
        return self._robot.limit_set.keep(q, pulls_at(self._robot, q))

    def _answer(
        self, scene: Snapshot, asked: StepQuery, initial: Floats, limits: RateLimits, dt: float, velocity: Floats | None
    ) -> Floats:
        """Make a step, of the loaded body where there is one; see `_advance`.

        Where motors of elastic actuators have rates, it is made again until they keep them all the way; at last the
        robot stays where it is.
        """
        if limits.motors is None:
            return self._one_answer(scene, asked, initial, limits, dt, velocity)
        bounds = MotorBounds(limits.motors, initial, dt, velocity)
        for tried in range(RETRIED + 1):
            own = asked._replace(motors=bounds.rows, still=tried == RETRIED)
            answer = self._one_answer(scene, own, initial, limits, dt, velocity)
            if bounds.keep(answer[t.CONFIGURATION : t.CONFIGURATION + initial.size].reshape(initial.shape)):
                break
        return answer

    def _one_answer(
        self, scene: Snapshot, asked: StepQuery, initial: Floats, limits: RateLimits, dt: float, velocity: Floats | None
    ) -> Floats:
        if self._group is None:
            room = a.most_constraints(len(initial))
            return self._loaded(scene)(asked, initial, limits, dt, velocity, room)
        return self._advance(scene, asked, initial, limits, dt, velocity)

    def _advance(
        self, scene: Snapshot, asked: StepQuery, initial: Floats, limits: RateLimits, dt: float, velocity: Floats | None
    ) -> Floats:
        """Make a step of `dt` seconds from `initial` (n, 3) and return the answer, see `kernels.velocity.query`.

        `limits` are those of a second; `velocity` (n, 3) is that of the step before, where accelerations are limited.
        """
        assert self._group is not None
        table = scene._kernel_group
        sizes = len(self._robot), int(table[0]), len(asked.targets), len(limits.actuators)
        scratch = self._scratch(sizes, limits, dt)
        head = asked.kind, *asked.motion, asked.rounds, asked.wish, asked.seconds, sizes[3], *scratch.room
        scratch.group[: a.HEADER] = head
        if velocity is not None:
            limits.write_before(scratch.group[a.HEADER :], dt, velocity)
        limits.write_motors(scratch.group[a.HEADER :], asked)
        if asked.still:
            self._local.limits = None  # what is written here is not that of the next step
        groups = self._group, table, self._settings, asked.targets
        if limits.tensions is not None and not limits.tensions.linear:
            return self._advance_within_tensions(groups, scratch, initial, limits)
        answer = np.empty(scratch.answer)
        t.control_step(*groups, scratch.group, initial, scratch.workspace, answer)
        return answer

    def _advance_within_tensions(
        self, groups: tuple[Floats, Floats, Floats, Floats], scratch: Scratch, initial: Floats, limits: RateLimits
    ) -> Floats:
        """Make a step of a robot of which rows of tensions are not linear.

        They are made linear where it begins. Where the way to the end leaves their bounds, these are made tighter by
        somewhat more; at last the robot stays where it is.
        """
        rows, own = limits.tensions, scratch.group[a.HEADER :]
        assert rows is not None
        allowed = np.maximum(LIMIT_ROUNDING * self._robot.mean_length, rows.excess(initial))
        answer, tighter = np.empty(scratch.answer), np.zeros(len(rows.lines))
        for tried in range(TIGHTENED + 1):
            limits.write_tensions(own, initial, tighter)
            if tried == TIGHTENED:
                limits.write_still(own)
                self._local.limits = None  # what is written here is not that of the next step
            t.control_step(*groups, scratch.group, initial, scratch.workspace, answer)
            end = answer[t.CONFIGURATION : t.CONFIGURATION + initial.size].reshape(initial.shape)
            off = rows.most_between(initial, end) - allowed
            if (off <= 0.0).all():
                break
            tighter += TIGHTER * np.maximum(0.0, off + allowed)
        return answer

    def _scratch(self, sizes: tuple[int, int, int, int], limits: RateLimits, dt: float) -> Scratch:
        """Scratch of this thread, with the limits of such a step in it; that of the last call is kept."""
        kept: Scratch | None = getattr(self._local, "scratch", None)
        if kept is None or self._local.sizes != sizes:
            n, m, _, p = self._local.sizes = sizes
            constraints = a.most_constraints(n)
            group = np.empty(a.HEADER + limits.segments.size + limits.actuators.size)
            answer = t.CONFIGURATION + 3 * n + t.ACTIVE_WIDTH * constraints
            kept = Scratch(group, np.empty(a.control_size(*sizes)), (a.most_bounds(n, m, p), constraints), answer)
            self._local.scratch, self._local.limits = kept, None
        if self._local.limits is not limits or self._local.dt != dt:
            limits.write(kept.group[a.HEADER :], dt)
            self._local.limits, self._local.dt = limits, dt
        return kept


def _numbers(key: str, value: Any, shape: tuple[int, int]) -> Floats:
    """Check finite numbers, and copy them: what is an array already takes a tenth of the time."""
    if type(value) is np.ndarray and value.dtype == np.float64 and value.shape == shape:
        given: Floats = np.array(value, order="C")
        if math.isfinite(given.sum()):
            return given
    return checks.array(key, value, shape).copy()


def read_twist(twist: Any, dt: float) -> tuple[int, tuple[float, ...]]:
    """Check a twist (6,) or a velocity (3,), and return what is asked for: its kind, and the motion in `dt` seconds."""
    numbers: Any = twist.tolist() if type(twist) is np.ndarray and twist.dtype == np.float64 else twist
    plain = isinstance(numbers, tuple | list) and len(numbers) in SIZES and set(map(type, numbers)) <= {int, float}
    if not (plain and math.isfinite(sum(numbers))):  # the quick way out of what is right already
        expected = "6 finite numbers (omega, v), or 3 (v)"
        numbers = checks.array("twist", twist, (None,), expected).tolist()
        if len(numbers) not in SIZES:
            raise InputError("twist", "", twist, expected)
    kind = MOVE_POSITION if len(numbers) == SIZES[0] else MOVE_POSE
    return kind, (*STILL[len(numbers) :], *[dt * each for each in numbers])
