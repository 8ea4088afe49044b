"""A motion: configurations at times, linear in q between them, and what is proved of all of it."""

from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np

from sinuous.answer.solution import Solution, demanded
from sinuous.answer.status import Status
from sinuous.answer.worst import Worst
from sinuous.base import checks
from sinuous.base.arguments import Number, Pair, Reconfigure, Rows, Stack, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.documents import described, result_of, result_value, write_document
from sinuous.base.entrance import import_late
from sinuous.base.errors import InputError, NotSolvedError, answers_attributes, duration, ranges, warn_of
from sinuous.base.frozen import Frozen, NotebookMixin
from sinuous.files.joint_chain import Of
from sinuous.kernels.packing import read_only
from sinuous.model.robot import Robot
from sinuous.motion import report, tables
from sinuous.motion.configurations import check_limits
from sinuous.motion.departure import Departure, Leg, find_departure, legs_between, measured_tips, tip_poses
from sinuous.motion.overlaps import overlap_on_the_way
from sinuous.motion.report import Report
from sinuous.motion.resampling import lines_between
from sinuous.scene.scene import SceneLike, as_snapshot, entries_of
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import SAMPLES, Steps, prove_steps
from sinuous.solver.polylines import interpolate
from sinuous.statics.rest import bodies_at

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    import sinuous as sn
    from sinuous.answer.explanation import Explanation
    from sinuous.answer.verification import MotionVerification
    from sinuous.base.arguments import LeaderParameter
    from sinuous.measures.following import Deviation
    from sinuous.model.rates import Rates
    from sinuous.motion.leader_derivative import LeaderDerivative
    from sinuous.problem.path import Curve
    from sinuous.problem.problem import Problem

Between = Literal["proved", "sampled", "unproved"]
"""What is known of the motion between knots: all of it is proved clear; or, of a loaded body, what is not proved is
clear at samples; or some step is neither."""


PRIVATE = {"ended": "_ended", "blocking": "_blocking", "deviation": "_deviation"}
"""Fields of a report that a motion has under other names."""


@answers_attributes(
    success="motion.solved",
    plot="sn.plot(motion)",
    show="sn.show(motion)",
    animate='sn.view.animate(motion, path="motion.gif")',
)
class Motion(NotebookMixin, Frozen):
    """Configurations at times, linear in q from each to the next; frozen.

    `track` and `plan` return one. Made of configurations from elsewhere, it proves what there is to prove.

    Parameters
    ----------
    robot : Robot
    q : array_like (T, n, 3)
        The knots: bend_x, bend_y (rad), length of every segment, within all limits; at least two.
    scene : Scene, Snapshot or list of obstacles, optional
        Where obstacles are `Moving`, everything is proved for the times at which they are where they are.
    times : array_like (T,), optional
        When the robot is at each knot, increasing; by default 0, 1, 2, ...

    Attributes
    ----------
    robot : Robot
    scene : Snapshot
        The obstacles as they were. Where a live scene was updated on the way, as they were at the end: all steps are
        proved in that, also those that were made before.
    configuration : ndarray (T, rows, 3)
        The knots, of joints and segments, read-only; `q` and `joints` are parts of it.
    times : ndarray (T,)
        Increasing, read-only; in seconds where rates or times were given, else a waypoint takes 1.
    steps : Steps
        What is proved of the motion from each knot to the next.
    solutions : tuple of Solution
        One for each waypoint that was tried, in their order.
    waypoint_knots : tuple of (int or None)
        The knot of each of these waypoints (0 = first): of what is not solved, none.
    reconfigured : tuple of int
        Waypoints (1 = first) to which the tip could not go straight: the robot changed its configuration while the tip
        stayed, or on another way, or, where no way was found, on a step that is not proved.
    reconfigure : str
        `refuse`: a motion of which the tip left the line between two waypoints is `left_path`. `allow`: it may.
    remaining : int
        Waypoints that were never tried, because the work was interrupted.
    seconds : float
        Time of all the work, without compiling.
    method : str
    seed : int
    notes : tuple of str
        What was done to a start, a goal or a knot: one that is beyond a limit by no more than 1e-3 (rad, or mean
        lengths of the robot) is brought within, see `Robot.clamp`.

    Raises
    ------
    InputError
        When an argument is not what it should be, or a knot violates a limit by more.
    """

    robot: Robot
    scene: Snapshot
    configuration: Floats
    times: Floats
    steps: Steps
    solutions: tuple[Solution, ...]
    waypoint_knots: tuple[int | None, ...]
    reconfigured: tuple[int, ...]
    reconfigure: Reconfigure
    remaining: int
    seconds: float
    method: str
    seed: int
    notes: tuple[str, ...]
    _ended: Status | None
    _blocking: Worst | None
    _deviation: float

    def __init__(
        self,
        robot: Robot,
        q: "Stack | Pair | list[Pair]",
        scene: SceneLike | Snapshot | None = None,
        times: Vector | None = None,
    ) -> None:
        checks.instance("robot", robot, Robot, "a Robot")
        knots = checks.rows("q", robot.configuration("q", q) if robot.joints else q, len(robot), 3)
        if len(knots) < 2:
            raise InputError("q", "", q, "at least two configurations")
        settled = [check_limits(robot, f"q[{i}]", knot) for i, knot in enumerate(knots)]
        knots, said = (
            read_only(np.array([knot for knot, _ in settled])),
            [note for _, notes in settled for note in notes],
        )
        notes = (*said[:1], *([f"q: {len(said) - 1} more knots are brought within limits"] if len(said) > 1 else []))
        place = as_snapshot(scene)
        when = np.arange(float(len(knots))) if times is None else checks.increasing("times", times, len(knots))
        steps = prove_steps(robot, place, knots, times=when)
        overlap = overlap_on_the_way(robot, place, knots, when, steps)
        ended = None if overlap is None else Status.BLOCKED
        self._put_together(robot, place, knots, when, steps, Report(notes=notes, ended=ended, blocking=overlap))

    @classmethod
    def made(cls, robot: Robot, scene: Snapshot, q: Floats, times: Floats, steps: Steps, found: Report) -> Self:
        """Put together what was found and proved already: T knots, which may be 0, and T - 1 steps."""
        motion = object.__new__(cls)
        motion._put_together(robot, scene, read_only(q), read_only(times), steps, found)
        return motion

    def _put_together(
        self, robot: Robot, scene: Snapshot, q: Floats, times: Floats, steps: Steps, found: Report
    ) -> None:
        self._set(robot=robot, scene=scene, configuration=q, times=times, steps=steps)
        self._set(**{PRIVATE.get(name, name): value for name, value in vars(found).items()})

    @property
    def q(self) -> Floats:
        """Of the segments: (T, n, 3), read-only; `configuration` where there are no joints."""
        return self.robot.segments_of(self.configuration)

    @property
    def joints(self) -> Floats:
        """Values (T, j) of the joints before the segments, in the order of `robot.joint_names`."""
        return self.robot.joints_of(self.configuration)

    @property
    def status(self) -> Status:
        """`solved` when every waypoint is and the whole motion is proved; `unproved` when only the proof lacks.

        Else the status of the first waypoint that is not solved, or `time_limit` when waypoints were not tried. Of a
        motion from elsewhere `blocked` where it was seen to overlap an obstacle or itself, or to be nearer to one than
        is demanded: see `worst`.
        `left_path` when all is proved, but the tip left the line between two waypoints, which it may not.
        """
        if self._ended is not None:
            return self._ended
        unsolved = next((solution.status for solution in self.solutions if not solution.solved), None)
        if unsolved is not None:
            return unsolved
        if self.remaining:
            return Status.TIME_LIMIT
        if self.unproved_steps:
            return Status.UNPROVED
        return Status.LEFT_PATH if self.reconfigure == "refuse" and self.left_steps else Status.SOLVED

    @property
    def solved(self) -> bool:
        """Whether every waypoint is solved, the whole motion is proved clear, and the tip followed its lines."""
        return self.status is Status.SOLVED

    @property
    def between(self) -> Between:
        """What is known of the motion between knots: `proved` clear all the way, `sampled`, or `unproved`.

        `sampled`: every step is proved, or is one of a loaded body that is clear at all shapes (`steps.samples`) at
        which it was looked at. That is no proof.
        """
        if not self.unproved_steps:
            return "proved"
        return "sampled" if (self.steps.proved | (self.steps.samples > 0)).all() else "unproved"

    @cached_property
    def unproved_steps(self) -> tuple[int, ...]:
        """Numbers of the steps that are not proved; step 1 leads from the first knot to the second."""
        return tuple((np.flatnonzero(~self.steps.proved) + 1).tolist())

    @cached_property
    def _departure(self) -> Departure:
        """How the tip left lines on the way to the waypoints where it was reconfigured."""
        numbers = set(self.reconfigured)
        legs = (leg for leg in self._legs() if numbers.intersection(range(leg.waypoints[0] + 1, leg.waypoints[1] + 1)))
        return (
            find_departure(self.robot, self.configuration, legs, self._deviation, tip_poses) if numbers else Departure()
        )

    def _legs(self) -> Iterator[Leg]:
        return legs_between(self.solutions, self.waypoint_knots)

    @property
    def left_steps(self) -> tuple[int, ...]:
        """Numbers of the steps in which the tip leaves the line between two waypoints, 1 = first.

        It is off by more than `deviation` of `track`, or turned by more than ten tolerances of angles, as far as that
        is seen by dense sampling.
        """
        return self._departure.steps

    @property
    def largest_deviation(self) -> tuple[float, float]:
        """How far the tip is off the line in these steps, and turned from it, at most (length unit, rad)."""
        return self._departure.position, self._departure.angle

    @property
    def clearance(self) -> float | None:
        """Proved lower bound of the clearance in the whole motion, or at the waypoints where that is not proved.

        `None` without obstacles, or when a waypoint has no proof.
        """
        return self._least([solution.clearance for solution in self.solutions], self.steps.clearance)

    @property
    def self_clearance(self) -> float | None:
        """Proved lower bound of the self-clearance, as for `clearance`; `None` where it does not matter."""
        return self._least([solution.self_clearance for solution in self.solutions], self.steps.self_clearance)

    @property
    def worst(self) -> Worst | None:
        """The constraint that is farthest from being met, of the first waypoint that is not solved.

        Of a motion from elsewhere that is `blocked`: where it was seen to overlap the deepest, with step and time.
        """
        found = next((solution.worst for solution in self.solutions if solution.worst is not None), None)
        return self._blocking if found is None else found

    @property
    def largest_step(self) -> tuple[float, float]:
        """Largest change of a bending vector (rad) and of a length between neighbouring knots."""
        if len(self.configuration) < 2:
            return 0.0, 0.0
        steps = np.diff(self.configuration, axis=0)
        return float(np.hypot(steps[..., 0], steps[..., 1]).max()), float(np.abs(steps[..., 2]).max())

    @property
    def duration(self) -> float:
        """Time from the first knot to the last; 0 without any."""
        return float(self.times[-1] - self.times[0]) if len(self.times) else 0.0

    @property
    def tips(self) -> Floats:
        """Poses (T, 4, 4) of the tool (of the tip, without one) at the knots, in the world."""
        return tip_poses(self.robot, self.configuration)

    @property
    def actuators(self) -> Floats:
        """Values (T, m) of all actuators at the knots, in the order of `robot.actuators`."""
        return self.robot.to_actuators(self.configuration)

    def at(self, t: Number | Stack) -> Floats:
        """Return the configuration at a time (n, 3), or at many times (..., n, 3).

        Raises
        ------
        InputError
            When a time is before the first knot or after the last one.
        """
        when = checks.stack("t", t, ())
        if not len(self.configuration):
            raise InputError("t", "the motion has no knots", t, "a motion with knots")
        outside = (when < self.times[0]) | (when > self.times[-1])
        if outside.any():
            wrong = when if when.ndim == 0 else when[outside][0]
            raise InputError("t", "", float(wrong), f"times from {self.times[0]:g} to {self.times[-1]:g}")
        return interpolate(self.times, self.configuration, when)

    def timed(self, rates: "Rates", blend: Number = 0.0) -> "sn.Trajectory":
        """Pass the same way as fast as rates and accelerations allow, from rest to rest.

        The way is made of straight lines, so under limits of acceleration the robot stops in every corner, unless that
        is rounded. With rates alone it never stops, and its speed jumps.

        Parameters
        ----------
        rates : Rates
        blend : float
            How far any place of the body may leave the way to round a corner, in the length unit. More than half of
            what is proved to be free is never used, so that a rounded corner is as clear as is proved; where nothing is
            proved, or where the way turns by a right angle or more, it stops. Under load places are those of the loaded
            body; it stops where nothing bounds that, as of tendons with a stiffness. Needs the extra `timing`. By
            default it stops in all corners (`Trajectory.stops`), which may take several times as long. The quickest of
            this blend, a quarter of it, and stops is returned.

        Raises
        ------
        InputError
            When `rates` do not limit all that moves, an argument is not what it should be, or obstacles move: then what
            is proved is proved for its times. Motors of elastic actuators jump where a tendon goes slack: the robot
            stops there where their accelerations are limited, and nothing is blended then; nor where they have rates
            and bend segments whose lengths change, of which these have no accelerations either.
        """
        trajectory: sn.Trajectory = import_late("motion.trajectory").timed(self, rates, blend)
        return trajectory

    def reversed(self) -> Self:
        """Return the same motion backwards: the knots from the last to the first, in the same time.

        What is proved of a step holds in both directions. Where obstacles move, it is another motion in the same time:
        all of it is proved anew, and it has no solutions.
        """
        times = self.times[:1] + (self.times[-1:] - self.times[::-1])  # begins at the same time, to the last digit
        if self.scene.moves and len(self.configuration) > 1:
            return type(self)(self.robot, self.configuration[::-1], self.scene, times)
        last, tried = len(self.configuration) - 1, len(self.solutions)
        found = self._report(
            blocking=None if self._blocking is None else self._blocking.at_times(self.times[::-1], times),
            solutions=self.solutions[::-1],
            waypoint_knots=tuple(None if knot is None else last - knot for knot in self.waypoint_knots[::-1]),
            reconfigured=tuple(tried + 2 - number for number in self.reconfigured[::-1] if 1 < number <= tried),
        )
        return self.made(self.robot, self.scene, self.configuration[::-1].copy(), times, self.steps.reversed(), found)

    def _report(self, **changed: Any) -> Report:
        """How it was found, with other values of some fields."""
        own = {field.name: getattr(self, PRIVATE.get(field.name, field.name)) for field in fields(Report)}
        return Report(**{**own, **changed})

    def with_waypoints(self, other: "Motion", waypoint_knots: tuple[int | None, ...]) -> Self:
        """Return the same motion with the waypoints of another one, at these knots."""
        found = other._report(waypoint_knots=waypoint_knots)
        return self.made(self.robot, self.scene, self.configuration, self.times, self.steps, found)

    def with_notes(self, notes: tuple[str, ...]) -> Self:
        """Return the same motion with other notes; itself where there are none."""
        if not notes:
            return self
        return self.made(self.robot, self.scene, self.configuration, self.times, self.steps, self._report(notes=notes))

    def with_times(self, times: Floats, ended: Status | None = None) -> Self:
        """Return the same motion at other times (T,), among obstacles that stand still; perhaps ended otherwise."""
        blocking = None if self._blocking is None else self._blocking.at_times(self.times, times)
        found = self._report(ended=self._ended if ended is None else ended, blocking=blocking)
        return self.made(self.robot, self.scene, self.configuration, times, self.steps, found)

    def resampled(self, rate: Number) -> Self:
        """Return the motion through configurations at an even rate (Hz), the last knot included.

        It cuts the corners of this one: each step that does is proved anew.

        Raises
        ------
        InputError
            When the rate is not greater than 0, or there are fewer than two knots.
        """
        times = tables.sample_times(self.times, checks.number("rate", rate, above=0.0))
        q = interpolate(self.times, self.configuration, times) if len(self.configuration) else self.configuration
        if len(q) < 2:
            raise InputError("motion", "has less than two knots", self, "a motion with steps")
        steps = lines_between(self.robot, self.scene, self.times, self.steps, times, q)
        overlap = overlap_on_the_way(self.robot, self.scene, q, times, steps) if self._ended is Status.BLOCKED else None
        found = Report() if overlap is None else Report(ended=Status.BLOCKED, blocking=overlap)
        return self.made(self.robot, self.scene, q, times, steps, found)

    def deviation(self, curve: "Rows | Curve", between: Whole = 4) -> "Deviation":
        """Measure how far the tip and the body are off a curve, by independent sampling.

        Parameters
        ----------
        curve : array_like (K, 3) or Curve
            Where the body enters, too: a straight line from the base leads to where it begins elsewhere.
        between : int
            Configurations that are looked at in every step, beside the knots.
        """
        from sinuous.measures.following import deviation, line_in_front  # noqa: PLC0415

        self._refuse_empty()
        count = checks.integer("between", between, 0, 10_000) + 1
        at = np.arange((len(self.configuration) - 1) * count + 1) / count
        when = np.interp(at, np.arange(len(self.configuration)), self.times)
        body, q = bodies_at(self.robot, interpolate(self.times, self.configuration, when))
        return deviation(body, q, line_in_front(self.robot, curve))

    def derivative(
        self, curve: "Rows | Curve", depths: Vector, wrt: "LeaderParameter | Sequence[LeaderParameter]" = ("advance",)
    ) -> "LeaderDerivative":
        """Derive the shapes of `follow_the_leader` by the curve, the advance, the base and the lengths.

        Parameters
        ----------
        curve : array_like (K, 3) or Curve
            That the motion follows.
        depths : array_like (T,)
            Increasing times of the motion at which it is derived. At the first and the last there is a kink.
        wrt : str or sequence of str
            Groups of parameters: `advance`, `curve`, `base`, `lengths`; see `sinuous.motion.leader_derivative`.

        Raises
        ------
        InputError
            When there is no such group, the motion follows another curve, a depth is not on it, or the robot is under
            load.
        """
        from sinuous.measures.following import line_in_front  # noqa: PLC0415
        from sinuous.motion.leader_derivative import LeaderDerivative, LeaderQuestion  # noqa: PLC0415

        self._refuse_empty()
        when = checks.increasing("depths", depths, None)
        if not len(when) or when[0] < self.times[0] or when[-1] > self.times[-1]:
            raise InputError("depths", "", depths, f"from {self.times[0]:g} to {self.times[-1]:g}")
        q = interpolate(self.times, self.configuration, when)
        return LeaderDerivative(LeaderQuestion.of(self.robot, q, line_in_front(self.robot, curve), when), q, wrt)

    def to_csv(self, file: str | Path, rate: Number | None = None, columns: Sequence[str] | None = None) -> Self:
        """Write times, configurations and the values of all actuators as CSV.

        Columns: `time`, `bend_x`, `bend_y`, `length` of every segment (`s1.bend_x`), every actuator by its name.

        Parameters
        ----------
        file : path
        rate : float, optional
            Rows a unit of time (Hz), the last knot included; by default one row a knot. At a rate the lines between
            rows cut corners of the motion: they are proved anew, and where one is not there is a warning.
        columns : sequence of str, optional
            Names of the columns after `time`, in this order, such as those of the motors; by default all.

        Returns
        -------
        Motion
            What was written: the motion through the rows, linear in q between them. It says what is proved of that.

        Raises
        ------
        InputError
            When the rate is not greater than 0, a column is not known, or the file cannot be written.
        """
        written = self._at_rate(rate)
        tables.write_motion(file, self.robot, written.times, written.configuration, columns)
        written.warn_of_corners(self, "lines")
        return written

    def to_ros(
        self, file: str | Path, rate: Number | None = None, of: Of = "joints", joints_per_segment: Whole = 8
    ) -> Self:
        """Write positions as JSON in the shape of a ROS 2 `trajectory_msgs/JointTrajectory`.

        There are no velocities, because between positions alone a controller moves along straight lines, and these are
        what is proved. `timed(rates).to_ros` writes velocities.

        Parameters
        ----------
        file : path
        rate : float, optional
            Points a unit of time (Hz), the last knot included; by default one point a knot. At a rate the lines between
            points cut corners of the motion: they are proved anew, and where one is not there is a warning.
        of : str
            `joints`: those that `Robot.to_urdf` writes, with as many `joints_per_segment`; or `actuators`.
        joints_per_segment : int

        Returns
        -------
        Motion
            What was written: the motion through the points, linear in q between them. It says what is proved of that.

        Raises
        ------
        InputError
            When an argument is not what it should be, the robot has no actuators where those are asked for, there are
            no knots, or the file cannot be written.
        """
        written = self._at_rate(rate)
        self._refuse_empty()
        tables.write_ros(file, self.robot, written.times, written.configuration, None, of, joints_per_segment)
        written.warn_of_corners(self, "lines")
        return written

    def warn_of_corners(self, motion: "Motion", way: str) -> None:
        """Warn where a motion is proved, and this, which was written of it, is not."""
        if motion.between == "proved" and self.between == "unproved":
            count, whole = len(self.unproved_steps), len(self.configuration) - 1
            text = f"{count} of {whole} {way} between rows are not proved clear, as the motion is: a higher rate helps"
            warn_of([f"rate: {text}"])

    def _refuse_empty(self) -> None:
        if not len(self.configuration):
            raise InputError("motion", "has no knots", self, "a motion with knots")

    def _at_rate(self, rate: Number | None) -> Self:
        """Return the motion that a file is of: this one, or the one through samples at an even rate."""
        if rate is None:
            return self
        often = checks.number("rate", rate, above=0.0)
        return self if len(self.configuration) < 2 else self.resampled(often)

    def explain(self, time: Number = 2.0) -> "Explanation":
        """Say why it ended like this, and what would help: each change that is told was tried, and all proved.

        Of a track or plan, what the first waypoint that is not solved says; of a motion that overlaps something, where,
        and whether it is clear without that obstacle or with a thinner body.

        Parameters
        ----------
        time : float
            Budget of all trials together, in seconds.

        Raises
        ------
        InputError
            When `time` is no number of at least 0.
        """
        found: Explanation = import_late("motion.explaining").explain_motion(self, _sentence(self), time)
        return found

    def verify(self) -> "MotionVerification":
        """Recompute every waypoint, and look at every step between knots densely, by an independent, slow path.

        Returns
        -------
        MotionVerification
            A list, which is `ok` when all are: one `Verification` of each waypoint that was tried, then one of each
            step, also of those that are not proved: its least
            clearances over so many configurations that no place of the body moves by more than a hundredth of the
            length of the body from one to the next. Of a step no target is asked; its `left_steps` are those in which
            the tip leaves a line that it has to follow.
        """
        from sinuous.answer.verification import MotionVerification, verify_steps  # noqa: PLC0415

        waypoints = [solution.verify() for solution in self.solutions]
        return MotionVerification(
            waypoints + verify_steps(self.robot, self.configuration, self.scene, self.times), self._seen_to_leave()
        )

    def _seen_to_leave(self) -> tuple[int, ...]:
        """Numbers of the steps in which the tip is off a line that it has to follow, by the slow path."""
        if self.reconfigure == "allow":
            return ()
        return find_departure(
            self.robot, self.configuration, self._legs(), self._deviation, measured_tips, np.inf
        ).steps

    def raise_for_status(self) -> Self:
        """Return this motion when it is solved.

        Raises
        ------
        NotSolvedError
            When it is not.
        """
        if not self.solved:
            raise NotSolvedError(f"{self.status} ({_sentence(self)})", self)
        return self

    @classmethod
    def from_dict(
        cls, values: "Mapping[str, Any]", problems: "Iterable[Problem]", scene: SceneLike | Snapshot | None = None
    ) -> "Motion":
        """Make a motion of its result as plain values, and of the problems of its waypoints, one after the other.

        Where obstacles move, the `scene` says how; that of each problem is then what the motion says when it was.

        It says what the result says; `verify` recomputes that, and `Motion(robot, q, scene, times)` proves it again.

        Raises
        ------
        InputError
            When `values` are no result of a motion, or one of another number of waypoints.
        """
        return cls.restored(dict(values), tuple(problems), scene=None if scene is None else as_snapshot(scene))

    @classmethod
    def restored(
        cls,
        values: dict[str, Any],
        problems: "tuple[Problem, ...]",
        place: tuple[Robot, Snapshot] | None = None,
        scene: Snapshot | None = None,
        asked: int | None = None,
    ) -> Self:
        """Make a motion of its result; see `sinuous.motion.report.read` for what is given."""
        parts = report.read(values, problems, place, scene, asked)
        motion = cls.made(*parts)
        status, worst = report.read_end(values)
        if motion.status is status and (worst is None or motion.worst is not None):
            return motion
        return cls.made(*parts._replace(found=replace(parts.found, ended=status, blocking=worst)))

    def to_dict(self) -> dict[str, Any]:
        """Return totals, knots and waypoints as plain values, in the order of the file format."""
        waypoints = [solution.to_dict() for solution in self.solutions]
        bend, length = self.largest_step
        return {
            "status": str(self.status),
            "base": self.robot.base.tolist(),
            **{name: _largest(waypoints, name) for name in ("position_error", "angle_error")},
            **result_of(self, "clearance self_clearance"),
            "demanded_clearance": demanded(self.robot.clearance),
            "demanded_self_clearance": demanded(self.robot.self_clearance),
            **result_of(self, "worst"),
            "reason": next((w["reason"] for w in waypoints if w["reason"] is not None), None),
            "binding": next((w["binding"] for w in waypoints if w["binding"]), []),
            **{name: sum(w[name] for w in waypoints) for name in ("iterations", "starts")},
            **result_of(self, "seconds method seed between unproved_steps reconfigured reconfigure"),
            "deviation": None if self._deviation == np.inf else self._deviation,
            "left_steps": list(self.left_steps),
            "largest_deviation": dict(zip(("position", "angle"), self.largest_deviation, strict=True)),
            "largest_step": {"bend": bend, "length": length},
            **result_of(self, "remaining times"),
            **({"joints": self.joints.tolist()} if self.robot.joints else {}),
            "knots": self.q.tolist(),
            **result_of(self, "waypoint_knots"),
            "waypoints": waypoints,
        }

    def save(self, file: str | Path) -> None:
        """Write the motion with its robot, scene and waypoints, JSON when it is called so, YAML otherwise.

        `sinuous.load` reads it, with all that is claimed of it; `Motion(robot, q, scene, times)` proves it again.
        Obstacles that were read from files stay there; the new file names them.

        Raises
        ------
        InputError
            When an obstacle is neither exact nor from a file, or the file cannot be written.
        """
        asked = [[described(target) for target in solution.problem.targets] for solution in self.solutions]
        parts = {
            "robot": self.robot.to_dict(),
            "scene": entries_of(self.scene.obstacles, Path(file).parent),
            "path": asked,
            "tolerance": described(self.solutions[0].problem.tolerance) if asked else None,
            "motion": {**self.to_dict(), "steps": result_value(self.steps.answers)},
        }
        write_document(file, {key: value for key, value in parts.items() if value})

    @classmethod
    def load(cls, file: str | Path, robot: Robot | None = None, scene: SceneLike | Snapshot | None = None) -> "Motion":
        """Read a motion: what `save`, `to_csv`, `to_ros` or `to_npz` wrote, or a result of the command line.

        A file of `save` holds its robot, scene and what is claimed of it. Of all others knots and times are read, for
        this robot and scene, and all is proved anew. A table has a column `time` (or `t`) and one for every coordinate
        (`s1.bend_x`) or every actuator, in its motor's unit; ROS JSON is a `JointTrajectory` of the joints of
        `Robot.to_urdf` or of actuators.

        Raises
        ------
        InputError
            When the file cannot be read, is of another kind or robot, or its values are those of no configuration.
        """
        found: Motion = import_late("motion.reading").read_motion(file, robot, scene)
        return found

    def to_npz(self, file: str | Path) -> None:
        """Write knots, times, actuators and what is proved of the steps as NumPy arrays; see `from_npz`.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        tables.write_npz(file, self.robot, self.times, self.configuration, self.steps.proved)

    @classmethod
    def from_npz(cls, file: str | Path, robot: Robot, scene: SceneLike | Snapshot | None = None) -> "Motion":
        """Read knots and times that `to_npz` wrote, for this robot and scene. All of it is proved anew.

        Raises
        ------
        InputError
            When the file cannot be read, or its knots are not for this robot.
        """
        q, times = tables.read_npz(file, robot)
        return cls(robot, q, scene, times)

    def _least(self, of_waypoints: list[float | None], between: float | None) -> float | None:
        """The least of proved clearances; `None` when that of a waypoint is missing."""
        if any(value is None for value in of_waypoints):
            return None
        known = [value for value in (*of_waypoints, between) if value is not None]
        return min(known, default=None)

    def _content(self) -> dict[str, Any]:
        names = (
            "robot",
            "scene",
            "q",
            "times",
            "waypoint_knots",
            "reconfigured",
            "reconfigure",
            "remaining",
            "seconds",
            "method",
            "seed",
            "status",
        )
        return {name: getattr(self, name) for name in names} | {"answers": self.steps.answers}

    def _shown(self) -> Iterator[str]:
        yield str(self.status)
        yield from (reached_in_words(self),) if self.solutions else ()
        yield f"{len(self.configuration)} knots"
        yield duration(self.seconds)

    def __str__(self) -> str:
        return _text(self)


def _text(motion: Motion) -> str:
    """Return what `print` shows of a motion."""
    bend, length = motion.largest_step
    parts = [f"Motion: {motion.status} ({_sentence(motion)})"]
    if motion.clearance is not None:
        where = "all the way" if motion.between == "proved" and len(motion.configuration) > 1 else "at the waypoints"
        parts.append(f"  clearance  {motion.clearance:.3g} {where}")
    if motion.between != "proved":
        seen = f", but are at {SAMPLES} shapes of each" if motion.between == "sampled" else ""
        parts.append(
            f"  between    {len(motion.unproved_steps)} of {len(motion.times) - 1} steps are not proved clear{seen}"
        )
    if motion.left_steps:
        parts.append(f"  left       {left_in_words(motion)}")
    if len(motion.configuration) > 1:
        parts.append(f"  time       {motion.times[0]:.4g} to {motion.times[-1]:.4g}, {len(motion.configuration)} knots")
        parts.append(f"  steps      at most {bend:.3g} rad of bend and {length:.3g} of length")
    parts.append(f"  effort     {duration(motion.seconds)}{_median(motion)}")
    return "\n".join(parts)


def reached_in_words(motion: Motion) -> str:
    """Say how many waypoints the motion comes to: a plan may know a shape for its goal, and no way there."""
    reached, count = len(motion.solutions) - motion.waypoint_knots.count(None), len(motion.solutions) + motion.remaining
    if count > 1:
        return f"{reached} of {count} waypoints reached"
    return "the target is reached" if reached else "the target is not reached"


def left_in_words(motion: Motion) -> str:
    """Say in which steps the tip is off the line between two waypoints, and how far at most; nothing where in none."""
    if not motion.left_steps:
        return ""
    off, turned = motion.largest_deviation
    turn = f" and turned by {turned:.3g} rad" if turned > 0.0 else ""
    steps, many = ranges(motion.left_steps), "s" if len(motion.left_steps) > 1 else ""
    return f"in step{many} {steps} the tip is up to {off:.3g} off the line between two waypoints{turn}"


def _sentence(motion: Motion) -> str:
    failed = next((i for i, solution in enumerate(motion.solutions) if not solution.solved), None)
    if failed is not None:
        solution = motion.solutions[failed]
        which = f"waypoint {failed + 1}: " if len(motion.solutions) + motion.remaining > 1 else ""
        return f"{reached_in_words(motion)}; {which}{solution.worst or solution.sentence}"
    begun = reached_in_words(motion) if motion.solutions else motion.status.sentence
    if motion.status is Status.RATE_BOUND and len(motion.configuration) > 1:
        return f"{begun}; the times that were asked for are too short for the rates"
    if motion.status is Status.LEFT_PATH:
        return f"{begun}; {left_in_words(motion)}"
    if motion.worst is not None:
        if motion.worst.step is not None:
            less = " or is nearer than is demanded" if motion.robot._demands_clearance else ""
            begun = f"a place of the body was seen that overlaps{less}"
        return f"{begun}; {motion.worst}"
    if motion.solutions and motion.status is Status.TIME_LIMIT and not motion.remaining:
        return f"{begun}; {motion.status.sentence}"
    return f"{begun}; {_where(motion)} not proved clear" if motion.unproved_steps else begun


def _where(motion: Motion) -> str:
    """Between which waypoints the first step that is not proved lies."""
    first = motion.unproved_steps[0]
    known = [(i, knot) for i, knot in enumerate(motion.waypoint_knots, 1) if knot is not None]
    for (i, a), (j, b) in pairwise(known):
        if a < first <= b:
            return f"the way from waypoint {i} to {j} is"
    return f"step {first} is"


def _median(motion: Motion) -> str:
    if not motion.solutions:
        return ""
    middle = float(np.median([solution.seconds for solution in motion.solutions]))
    return f", median {duration(middle)} a solve"


def _largest(results: list[dict[str, Any]], key: str) -> float | None:
    return max((result[key] for result in results if result[key] is not None), default=None)
