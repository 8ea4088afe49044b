"""A trajectory: the path of a motion, passed as fast as the robot may."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, NotebookMixin, call
from sinuous.files.joint_chain import Of
from sinuous.model.rates import Rates, Spread
from sinuous.model.robot import Robot
from sinuous.motion import tables
from sinuous.motion.blending import BlendedPath, blend_corners, cut_at_jumps, legs_of, stop_at_corners
from sinuous.motion.report import Report
from sinuous.motion.resampling import splines_between
from sinuous.motion.timing import Scaling, scale_blended, scale_with_stops

if TYPE_CHECKING:
    from sinuous.motion.motion import Motion


BLENDS = (0.25, 1.0)
"""Shares of the allowed blend that are tried, besides stopping: a wide blend that is slow can take longer."""

TOGETHER = 1e-9
"""Share of the duration within which two times are one."""


class Trajectory(NotebookMixin, Frozen):
    """A path through configuration space and a time scaling of it; `Motion.timed` makes one.

    Between two `times` the speed along the path changes evenly.

    Attributes
    ----------
    motion : Motion
        Whose path it is.
    times : ndarray (M + 1,)
        Seconds from 0 on, increasing, read-only.
    """

    motion: "Motion"
    times: Floats
    _path: BlendedPath
    _scaling: Scaling

    def __init__(self, motion: "Motion", path: BlendedPath, scaling: Scaling) -> None:
        times = np.concatenate([[0.0], np.cumsum(scaling.phases[:, 0])])
        times.flags.writeable = False
        self._set(motion=motion, times=times, _path=path, _scaling=scaling)

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self.motion.robot

    @property
    def duration(self) -> float:
        """Seconds from the first configuration to the last."""
        return float(self.times[-1])

    def at(self, t: Number | Vector) -> Floats:
        """Configurations (..., n, 3) at times (...), in seconds.

        Raises
        ------
        InputError
            When a time is before 0 or after the end.
        """
        _, piece, s, _ = self._where(t)
        return self._path.at(piece, s)

    def velocity(self, t: Number | Vector) -> Floats:
        """Rates (..., n, 3) of the configuration at times (...); where it jumps, that of what comes after."""
        _, piece, s, speed = self._where(t)
        return self._path.at(piece, s, 1) * speed[..., None, None]

    def acceleration(self, t: Number | Vector) -> Floats:
        """Derivatives (..., n, 3) of the rates at times (...); where they jump, those of what comes after."""
        phase, piece, s, speed = self._where(t)
        gained = self._scaling.phases[phase, 3][..., None, None]
        slope, turn = self._path.at(piece, s, 1), self._path.at(piece, s, 2)
        return slope * gained + turn * (speed**2)[..., None, None]

    @property
    def stops(self) -> int:
        """How many times the robot stops on its way: in corners that are not rounded, where accelerations are limited.

        To stop in every corner can take several times as long as to round them a little, see `blend` of `Motion.timed`.
        """
        rest = self._scaling.phases[1:, 2] == 0.0
        return int((rest & (np.diff(self._scaling.piece) > 0)).sum())

    def as_motion(self) -> "Motion":
        """Return the motion through the configurations at `times` and at the waypoints, linear in q between them.

        All of it is proved anew. It has the solutions of the motion that is passed; where corners are rounded, its
        waypoints are where it comes nearest to those.
        """
        knots = [knot for knot in self.motion.waypoint_knots if knot is not None]
        passed = [self._passes(self.motion.configuration[knot]) for knot in knots]
        times = np.unique(np.concatenate([self.times, passed]))
        far = np.diff(times) > TOGETHER * self.duration
        times = times[np.concatenate([[True], far[:-1] | np.isin(times[1:-1], self.times), [True]])]
        found, own = self._through(times), iter(passed)
        at = [None if knot is None else int(np.abs(times - next(own)).argmin()) for knot in self.motion.waypoint_knots]
        return found.with_waypoints(self.motion, tuple(at))

    def _passes(self, q: Floats) -> float:
        """When the trajectory is at a configuration (n, 3), or comes nearest to it."""
        pieces = self._path.pieces
        slopes = pieces[:, 1].reshape(len(pieces), -1)
        apart = (q - pieces[:, 0]).reshape(len(pieces), -1)
        along = np.clip((apart * slopes).sum(axis=1) / (slopes**2).sum(axis=1), 0.0, self._path.lengths)
        places = self._path.at(np.arange(len(pieces)), along)
        piece = int(((places - q) ** 2).sum(axis=(1, 2)).argmin())
        phases = np.flatnonzero(self._scaling.piece == piece)
        phase = phases[np.searchsorted(self._scaling.phases[phases, 1], along[piece], side="right") - 1]
        duration, begin, speed, gain = self._scaling.phases[phase]
        ahead = max(0.0, along[piece] - begin)
        top = np.sqrt(max(0.0, speed * speed + 2.0 * gain * ahead))
        after = 2.0 * ahead / (speed + top) if speed + top > 0.0 else 0.0
        return float(min(self.times[phase] + min(after, duration), self.duration))

    def resampled(self, rate: Number) -> "Motion":
        """Return the motion through configurations at an even rate (Hz), the last included; all is proved anew."""
        return self._through(self._samples(rate))

    def to_csv(self, file: str | Path, rate: Number | None = None, columns: Sequence[str] | None = None) -> "Motion":
        """Write times, configurations and values of all actuators as CSV; columns as of `Motion.to_csv`.

        Parameters
        ----------
        file : path
        rate : float, optional
            Rows a second (Hz), the end included; by default a row for each of `times`.
        columns : sequence of str, optional
            Names of the columns after `time`, in this order; by default all.

        Returns
        -------
        Motion
            What was written: the motion through the rows, linear in q between them, all proved anew. Where a line is
            not, as the motion is, there is a warning.
        """
        written = self._through(self._samples(rate))
        tables.write_motion(file, self.robot, written.times, written.configuration, columns)
        written.warn_of_corners(self.motion, "lines")
        return written

    def to_ros(
        self, file: str | Path, rate: Number | None = None, of: Of = "joints", joints_per_segment: Whole = 8
    ) -> "Motion":
        """Write positions and velocities as JSON in the shape of a ROS 2 `trajectory_msgs/JointTrajectory`.

        Parameters
        ----------
        file : path
        rate : float, optional
            Points a second (Hz); by default a point for each of `times`. Through these a cubic spline, which is what
            controllers make of positions and velocities, is the trajectory itself on straight pieces.
        of : str
            `joints`: those that `Robot.to_urdf` writes, with as many `joints_per_segment`; or `actuators`.
        joints_per_segment : int

        Returns
        -------
        Motion
            What was written: the motion through the points. Its steps are proved where the cubic splines between the
            points are, and the straight lines, too. Where one is not, as the motion is, there is a warning.
        """
        lines = self._through(self._samples(rate))
        velocities = self.velocity(lines.times)
        velocities[-1] = 0.0
        tables.write_ros(file, self.robot, lines.times, lines.configuration, velocities, of, joints_per_segment)
        steps = splines_between(self.robot, lines.times, lines.configuration, velocities, lines.steps)
        written = lines.made(self.robot, lines.scene, lines.configuration, lines.times, steps, Report())
        written.warn_of_corners(self.motion, "splines")
        return written

    def save(self, file: str | Path) -> "Motion":
        """Write the motion through `times`, as `Motion.save` does, and return it: all proved anew."""
        written = self.as_motion()
        written.save(file)
        return written

    def to_npz(self, file: str | Path) -> "Motion":
        """Write knots at `times` as NumPy arrays, as `Motion.to_npz` does, and return the motion through them."""
        written = self.as_motion()
        written.to_npz(file)
        return written

    def __repr__(self) -> str:
        stops = [f"{self.stops} stops in corners"] if self.stops else []
        return call("Trajectory", [f"{self.duration:.4g} s", *stops, f"{len(self.robot.segments)} segments"])

    def _through(self, times: Floats) -> "Motion":
        """Return the motion through configurations at these times, proved."""
        return type(self.motion)(self.robot, self.at(times), self.motion.scene, times)

    def _samples(self, rate: Number | None) -> Floats:
        return self.times if rate is None else tables.sample_times(self.times, checks.number("rate", rate, above=0.0))

    def _where(self, t: Number | Vector) -> tuple[np.ndarray, np.ndarray, Floats, Floats]:
        """Phases, pieces, places on them and speeds there, all (...)."""
        when = checks.stack("t", t, ())
        if ((when < 0.0) | (when > self.duration)).any():
            wrong = float(when.flat[int(np.argmax((when < 0.0) | (when > self.duration)))])
            raise InputError("t", "", wrong, f"times from 0 to {self.duration:g}")
        phase = np.clip(np.searchsorted(self.times, when, side="right") - 1, 0, len(self._scaling.phases) - 1)
        _, begin, speed, gain = np.moveaxis(self._scaling.phases[phase], -1, 0)
        dt = when - self.times[phase]
        s = begin + dt * (speed + 0.5 * dt * gain)
        piece = self._scaling.piece[phase]
        return phase, piece, np.clip(s, 0.0, self._path.lengths[piece]), speed + dt * gain


def timed(motion: "Motion", rates: Rates, blend: Number = 0.0) -> Trajectory:
    """Pass the path of a motion as fast as rates and accelerations allow; see `Motion.timed`."""
    checks.instance("rates", rates, Rates, "Rates")
    if motion.scene.moves:
        raise InputError("motion", "obstacles move", motion, "one among obstacles that stand still: it has other times")
    limits, accelerations = rates.spread(motion.robot), rates.further(motion.robot)
    most = checks.number("blend", blend, low=0.0)
    if most > 0.0 and accelerations is None:
        raise InputError("blend", "rates have no acceleration, so there are no stops to blend", most, "0")
    _refuse_elastic(motion.robot, limits, accelerations, most)
    legs = legs_of(motion.robot, motion.configuration, motion.steps)
    if not len(legs.sizes):
        raise InputError("motion", "stands still", motion, "a motion that moves")
    if accelerations is not None and accelerations.limits_elastic(motion.robot):
        legs = cut_at_jumps(motion.robot, legs)
    path = stop_at_corners(legs)
    found = [Trajectory(motion, path, scale_with_stops(motion.robot, path, limits, accelerations))]
    if accelerations is not None and most > 0.0 and len(legs.sizes) > 1:
        for share in BLENDS:
            path = blend_corners(motion.robot, legs, share * most)
            found.append(Trajectory(motion, path, scale_blended(motion.robot, path, limits, accelerations)))
    return min(reversed(found), key=lambda each: each.duration)


def _refuse_elastic(robot: Robot, rates: Spread, accelerations: Spread | None, blend: float) -> None:
    """Refuse what is not known of motors whose values include a stretch."""
    elastic, accelerates = robot.drive.elastic, accelerations is not None and accelerations.limits_elastic(robot)
    if elastic is None or not (accelerates or rates.limits_elastic(robot)):
        return
    if accelerates and not elastic.speeds.linear:
        problem = "elastic actuators bend segments whose lengths change"
        raise InputError("rates.acceleration.actuator", problem, None, "none for elastic actuators")
    if blend > 0.0 and accelerates:
        raise InputError(
            "blend", "accelerations limit elastic actuators, which jump where tendons go slack", blend, "0"
        )
    if blend > 0.0 and not elastic.speeds.linear:
        raise InputError("blend", "rates limit elastic actuators of segments whose lengths change", blend, "0")
