"""From targets to pieces of trajectories of the motors: plain Python, without ROS."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import sinuous as sn

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Piece:
    """What the motors are to do next.

    Names (m,), times (T,) in seconds from the beginning of the piece, and positions and velocities (T, m) in the units
    of the motors.
    """

    names: list[str]
    times: Floats
    positions: Floats
    velocities: Floats


class ArmPlanner:
    """Plans for the robot of a problem file, and says what comes next.

    Parameters
    ----------
    job : path
        Problem file with `start` and `rates`.
    clock : callable
        What time it is, in seconds.
    rate : float
        Points a second.
    seconds : float
        Time for a plan.

    Raises
    ------
    sinuous.InputError
        When the file cannot be meant, or has no start, no rates, or no actuators.
    """

    def __init__(self, job: str, clock: Callable[[], float], rate: float = 50.0, seconds: float = 2.0) -> None:
        loaded = sn.load(job, sn.Job)
        if loaded.start is None:
            raise sn.InputError("start", "missing", None, "where the robot is at first", job)
        if not loaded.rates:
            raise sn.InputError("rates", "missing", None, "how fast the motors may be", job)
        if not loaded.robot.actuators:
            raise sn.InputError("robot", "has no actuators", loaded.robot, "tendons, chambers, stages or rows", job)
        self.robot, self.rates, self.clock = loaded.robot, loaded.rates, clock
        self.names = [actuator.name for actuator in self.robot.actuators]
        self._planner = sn.Planner(self.robot, loaded.scene, time=seconds, tolerance=loaded.tolerance)
        self._at_rest: Floats = np.array(loaded.start)
        self._under_way: tuple[sn.Trajectory, float] | None = None
        """A trajectory and when it began: one attribute, because another thread asks for pieces."""
        self._spacing = 1.0 / rate

    @property
    def moves(self) -> bool:
        """Whether a trajectory is under way."""
        under_way = self._under_way
        return under_way is not None and self.clock() < under_way[1] + under_way[0].duration

    @property
    def q(self) -> Floats:
        """Where the robot is told to be (n, 3)."""
        if self._under_way is None:
            return self._at_rest
        trajectory, begun = self._under_way
        return trajectory.at(min(max(0.0, self.clock() - begun), trajectory.duration))

    def measured(self, values: Mapping[str, float], tolerance: float) -> None:
        """Take where the motors are, by name; while a trajectory is under way nothing is taken.

        They may contradict each other by `tolerance`, in the units of the motors.

        Raises
        ------
        sinuous.InputError
            When they contradict each other by more, or one is missing.
        """
        if not self.moves:
            own = {name: values[name] for name in self.names if name in values}
            self._at_rest = self.robot.from_actuators(own, initial=self.q, tolerance=tolerance)
            self._under_way = None

    def go(self, position: Sequence[float] | None, xyzw: Sequence[float] | None = None) -> sn.Motion:
        """Plan from where the robot is at rest to a target, and begin once a motion is found.

        Returns the plan: when it is not `solved`, the robot stays where it is, and its text says why.

        Raises
        ------
        sinuous.InputError
            When the target cannot be meant, or a trajectory is under way.
        """
        if self.moves:
            raise sn.InputError("target", "a motion is under way", position, "a target once it has ended")
        motion = self._planner.plan(self.q, sn.Target(position, xyzw=xyzw))
        if motion.solved and len(motion.q) > 1 and np.ptp(motion.q, axis=0).any():
            self._under_way = motion.timed(self.rates), self.clock()
        return motion

    def piece(self, horizon: float) -> Piece | None:
        """Return what comes within the next `horizon` seconds; None when nothing is under way."""
        if self._under_way is None or not self.moves:
            return None
        trajectory, begun = self._under_way
        begin = min(max(0.0, self.clock() - begun), trajectory.duration)
        end = min(begin + horizon, trajectory.duration)
        times = np.linspace(begin, end, max(2, 1 + round((end - begin) / self._spacing)))
        q, speeds = trajectory.at(times), trajectory.velocity(times)
        if end == trajectory.duration:
            speeds[-1] = 0.0
        velocities = (self.robot.actuator_jacobian(q) @ speeds.reshape(len(times), -1, 1))[..., 0]
        return Piece(self.names, times - begin, self.robot.to_actuators(q), velocities)
