"""What is done with a motion: timed, turned round, measured, and written for other programs."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np

from sinuous import checks
from sinuous.arguments import Number, Rows, Whole
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.export.joints import Of, joint_map
from sinuous.export.ros import joint_trajectory, write_json
from sinuous.frozen import Frozen
from sinuous.motion import arrays, table
from sinuous.motion.told import Told
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot
from sinuous.solution.solution import Solution
from sinuous.solution.status import Status
from sinuous.solution.worst import Worst
from sinuous.solving.between.steps import Steps

if TYPE_CHECKING:
    from sinuous.measures.following import Deviation
    from sinuous.motion.motion import Motion
    from sinuous.motion.timing.trajectory import Trajectory
    from sinuous.problem.curve import Curve
    from sinuous.robot.rates import Rates


class Uses(Frozen):
    """What a `Motion` is made of, see there, and what can be done with it."""

    robot: Robot
    scene: Snapshot
    q: Floats
    times: Floats
    steps: Steps
    solutions: tuple[Solution, ...]
    waypoint_knots: tuple[int | None, ...]
    reconfigured: tuple[int, ...]
    remaining: int
    seconds: float
    method: str
    seed: int
    _ended: Status | None
    _blocking: Worst | None

    if TYPE_CHECKING:  # those of `Motion`

        def __init__(self, robot: Robot, q: Any, scene: Any = None, times: Any = None) -> None: ...

        @classmethod
        def made(cls, robot: Robot, scene: Snapshot, q: Floats, times: Floats, steps: Steps, told: Told) -> Self:
            """See `Motion.made`."""
            ...

    def timed(self, rates: "Rates", blend: Number = 0.0) -> "Trajectory":
        """Pass the same way as fast as rates and accelerations allow, from rest to rest.

        The way is made of straight lines, so under limits of acceleration the robot stops in every corner, unless that
        is rounded. With rates alone it never stops, and its speed jumps.

        Parameters
        ----------
        rates : Rates
        blend : float
            How far any place of the body may leave the way to round a corner, in the length unit. More than half of
            what is proved to be free is never used, so that a rounded corner is as clear as is proved; where nothing is
            proved, or where the way turns by a right angle or more, it stops. Needs the extra `timing`.

        Raises
        ------
        InputError
            When `rates` do not limit all that moves, an argument is not what it should be, or obstacles move: then what
            is proved is proved for its times.
        """
        from sinuous.motion.timing.timed import timed  # noqa: PLC0415

        return timed(cast("Motion", self), rates, blend)

    def reversed(self) -> Self:
        """Return the same motion backwards: the knots from the last to the first, in the same time.

        What is proved of a step holds in both directions. Where obstacles move, it is another motion in the same time:
        all of it is proved anew, and it has no solutions.
        """
        times = self.times[:1] + (self.times[-1:] - self.times[::-1])  # begins at the same time, to the last digit
        if self.scene.moves and len(self.q) > 1:
            return type(self)(self.robot, self.q[::-1], self.scene, times)
        last, tried = len(self.q) - 1, len(self.solutions)
        told = Told(
            solutions=self.solutions[::-1],
            waypoint_knots=tuple(None if knot is None else last - knot for knot in self.waypoint_knots[::-1]),
            reconfigured=tuple(tried + 2 - number for number in self.reconfigured[::-1] if 1 < number <= tried),
            remaining=self.remaining,
            seconds=self.seconds,
            method=self.method,
            seed=self.seed,
            ended=self._ended,
            blocking=self._blocking,
        )
        return self.made(self.robot, self.scene, self.q[::-1].copy(), times, self.steps.reversed(), told)

    def resampled(self, rate: Number) -> Self:
        """Return the motion through configurations at an even rate (Hz), the last knot included.

        It cuts the corners of this one, so every step is proved anew.

        Raises
        ------
        InputError
            When the rate is not greater than 0, or there are fewer than two knots.
        """
        times, q = self._samples(rate)
        return type(self)(self.robot, q, self.scene, times)

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

        if not len(self.q):
            raise InputError("motion", "has no knots", self, "a motion with knots")
        count = checks.integer("between", between, 0, 10_000) + 1
        at = np.arange((len(self.q) - 1) * count + 1) / count
        when = np.interp(at, np.arange(len(self.q)), self.times)
        return deviation(self.robot, arrays.interpolate(self.times, self.q, when), line_in_front(self.robot, curve))

    def to_csv(self, file: str | Path, rate: Number | None = None) -> None:
        """Write times, configurations and the values of all actuators as CSV.

        Columns: `time`, `bend_x`, `bend_y`, `length` of every segment (`s1.bend_x`), every actuator by its name.

        Parameters
        ----------
        file : path
        rate : float, optional
            Rows a unit of time (Hz), the last knot included; by default one row a knot. At a rate the lines between
            rows cut corners of the motion, and are not proved: for this write `resampled(rate)`.

        Raises
        ------
        InputError
            When the rate is not greater than 0, or the file cannot be written.
        """
        table.write_motion(file, self.robot, *self._samples(rate))

    def to_ros(
        self, file: str | Path, rate: Number | None = None, of: Of = "joints", joints_per_segment: Whole = 8
    ) -> None:
        """Write positions as JSON in the shape of a ROS 2 `trajectory_msgs/JointTrajectory`.

        There are no velocities, because between positions alone a controller moves along straight lines, and these are
        what was proved. `timed(rates).to_ros` writes velocities.

        Parameters
        ----------
        file : path
        rate : float, optional
            Points a unit of time (Hz), the last knot included; by default one point a knot. At a rate the lines between
            points cut corners of the motion, and are not proved: for this write `resampled(rate)`.
        of : str
            `joints`: those that `Robot.to_urdf` writes, with as many `joints_per_segment`; or `actuators`.
        joints_per_segment : int

        Raises
        ------
        InputError
            When an argument is not what it should be, the robot has no actuators where those are asked for, there are
            no knots, or the file cannot be written.
        """
        times, q = self._samples(rate)
        if not len(q):
            raise InputError("motion", "has no knots", self, "a motion with knots")
        names, matrix = joint_map(self.robot, of, joints_per_segment)
        write_json(file, joint_trajectory(names, times, q.reshape(len(q), -1) @ matrix.T))

    def _samples(self, rate: Number | None) -> tuple[Floats, Floats]:
        """Times and configurations, of the knots or at an even rate."""
        if rate is None:
            return self.times, self.q
        times = arrays.samples(self.times, checks.number("rate", rate, above=0.0))
        return times, arrays.interpolate(self.times, self.q, times)
