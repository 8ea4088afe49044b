"""A motion: configurations at times, linear in q between them, and what is proved of all of it."""

from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np

from sinuous import checks
from sinuous.arguments import Number, Stack, Vector
from sinuous.checks import Floats
from sinuous.errors import InputError, NotSolvedError
from sinuous.motion import arrays, plain, wording
from sinuous.motion.start import check_limits
from sinuous.motion.times import even_times
from sinuous.motion.told import Told
from sinuous.motion.uses import Uses
from sinuous.notebook import NotebookMixin
from sinuous.packing import read_only
from sinuous.robot.robot import Robot
from sinuous.scene.scene import SceneLike, as_snapshot
from sinuous.scene.snapshot import Snapshot
from sinuous.solution.status import Status
from sinuous.solution.verification import Worst
from sinuous.solving.between.steps import Steps, prove_steps
from sinuous.words import duration

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from sinuous.problem.problem import Problem
    from sinuous.solution.verification import Verification

Between = Literal["proved", "unproved"]
"""What is known of the motion between knots: all of it is proved clear, or some step is not."""


class Motion(NotebookMixin, Uses):
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
    q : ndarray (T, n, 3)
        The knots, read-only.
    times : ndarray (T,)
        Increasing, read-only; in seconds where rates or times were given, else a waypoint takes 1.
    steps : Steps
        What is proved of the motion from each knot to the next.
    solutions : tuple of Solution
        One for each waypoint that was tried, in their order.
    waypoint_knots : tuple of (int or None)
        The knot of each of these waypoints (0 = first): of what is not solved, none.
    reconfigured : tuple of int
        Waypoints (1 = first) to which the tip could not go straight: the robot changed its configuration on another
        way, or, where no way was found, on a step that is not proved.
    remaining : int
        Waypoints that were never tried, because the work was interrupted.
    seconds : float
        Time of all the work, without compiling.
    method : str
    seed : int

    Raises
    ------
    InputError
        When an argument is not what it should be, or a knot violates a limit.
    """

    def __init__(
        self,
        robot: Robot,
        q: Stack,
        scene: SceneLike | Snapshot | None = None,
        times: Vector | None = None,
    ) -> None:
        if not isinstance(robot, Robot):
            raise InputError("robot", "", robot, "a Robot")
        knots = checks.rows("q", q, len(robot), 3)
        if len(knots) < 2:
            raise InputError("q", "", q, "at least two configurations")
        for i, knot in enumerate(knots):
            check_limits(robot, f"q[{i}]", knot)
        place = as_snapshot(scene)
        when = even_times(len(knots)) if times is None else checks.increasing("times", times, len(knots))
        self._set(robot=robot, scene=place, q=knots, times=when, steps=prove_steps(robot, place, knots, times=when))
        self._tell(Told())

    @classmethod
    def made(cls, robot: Robot, scene: Snapshot, q: Floats, times: Floats, steps: Steps, told: Told) -> Self:
        """Put together what was found and proved already: T knots, which may be 0, and T - 1 steps."""
        motion = object.__new__(cls)
        motion._set(robot=robot, scene=scene, q=read_only(q), times=read_only(times), steps=steps)
        motion._tell(told)
        return motion

    def _tell(self, told: Told) -> None:
        shown = {name: value for name, value in vars(told).items() if name not in ("ended", "blocking")}
        self._set(**shown, _ended=told.ended, _blocking=told.blocking)

    @property
    def status(self) -> Status:
        """`solved` when every waypoint is and the whole motion is proved; `unproved` when only the proof lacks.

        Else the status of the first waypoint that is not solved, or `time_limit` when waypoints were not tried.
        """
        if self._ended is not None:
            return self._ended
        unsolved = next((solution.status for solution in self.solutions if not solution.solved), None)
        if unsolved is not None:
            return unsolved
        if self.remaining:
            return Status.TIME_LIMIT
        return Status.UNPROVED if self.unproved_steps else Status.SOLVED

    @property
    def solved(self) -> bool:
        """Whether every waypoint is solved and the whole motion is proved clear."""
        return self.status is Status.SOLVED

    @property
    def between(self) -> Between:
        """What is known of the motion between knots: `proved` clear all the way, or `unproved`."""
        return "unproved" if self.unproved_steps else "proved"

    @cached_property
    def unproved_steps(self) -> tuple[int, ...]:
        """Numbers of the steps that are not proved; step 1 leads from the first knot to the second."""
        return tuple((np.flatnonzero(~self.steps.proved) + 1).tolist())

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
        """The constraint that is farthest from being met, of the first waypoint that is not solved."""
        found = next((solution.worst for solution in self.solutions if solution.worst is not None), None)
        return self._blocking if found is None else found

    @property
    def largest_step(self) -> tuple[float, float]:
        """Largest change of a bending vector (rad) and of a length between neighbouring knots."""
        if len(self.q) < 2:
            return 0.0, 0.0
        steps = np.diff(self.q, axis=0)
        return float(np.hypot(steps[..., 0], steps[..., 1]).max()), float(np.abs(steps[..., 2]).max())

    @property
    def actuators(self) -> Floats:
        """Values (T, m) of all actuators at the knots, in the order of `robot.actuators`."""
        return self.robot.to_actuators(self.q)

    def at(self, t: Number | Stack) -> Floats:
        """Return the configuration at a time (n, 3), or at many times (..., n, 3).

        Raises
        ------
        InputError
            When a time is before the first knot or after the last one.
        """
        when = checks.stack("t", t, ())
        if not len(self.q):
            raise InputError("t", "the motion has no knots", t, "a motion with knots")
        outside = (when < self.times[0]) | (when > self.times[-1])
        if outside.any():
            wrong = when if when.ndim == 0 else when[outside][0]
            raise InputError("t", "", float(wrong), f"times from {self.times[0]:g} to {self.times[-1]:g}")
        return arrays.interpolate(self.times, self.q, when)

    def verify(self) -> "list[Verification]":
        """Recompute every waypoint by an independent, slow path."""
        return [solution.verify() for solution in self.solutions]

    def raise_for_status(self) -> Self:
        """Return this motion when it is solved.

        Raises
        ------
        NotSolvedError
            When it is not.
        """
        if not self.solved:
            raise NotSolvedError(str(self), self)
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
        place = None if scene is None else as_snapshot(scene)
        return plain.read(cls, values, tuple(problems), scene=place)

    def to_dict(self) -> dict[str, Any]:
        """Return totals, knots and waypoints as plain values, in the order of the file format."""
        return plain.write(self)

    def to_npz(self, file: str | Path) -> None:
        """Write knots, times, actuators and what is proved of the steps as NumPy arrays; see `from_npz`.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        arrays.save(self, file)

    @classmethod
    def from_npz(cls, file: str | Path, robot: Robot, scene: SceneLike | Snapshot | None = None) -> "Motion":
        """Read knots and times that `to_npz` wrote, for this robot and scene. All of it is proved anew.

        Raises
        ------
        InputError
            When the file cannot be read, or its knots are not for this robot.
        """
        q, times = arrays.load(file, robot)
        return cls(robot, q, scene, times)

    def _least(self, of_waypoints: list[float | None], between: float | None) -> float | None:
        """The least of proved clearances; `None` when that of a waypoint is missing."""
        if any(value is None for value in of_waypoints):
            return None
        known = [value for value in (*of_waypoints, between) if value is not None]
        return min(known, default=None)

    def _content(self) -> dict[str, Any]:
        told = (
            "robot",
            "scene",
            "q",
            "times",
            "waypoint_knots",
            "reconfigured",
            "remaining",
            "seconds",
            "method",
            "seed",
            "status",
        )
        return {name: getattr(self, name) for name in told} | {"answers": self.steps.answers}

    def _shown(self) -> Iterator[str]:
        yield str(self.status)
        yield from (f"{wording.counted(self)} solved",) if self.solutions else ()
        yield f"{len(self.q)} knots"
        yield duration(self.seconds)

    def __str__(self) -> str:
        return wording.text(self)
