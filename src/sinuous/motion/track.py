"""Follow a path: targets solved one after the other, each from the last."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

import numpy as np

from sinuous import checks
from sinuous.brief import call
from sinuous.checks import Floats
from sinuous.errors import InputError, NotSolvedError
from sinuous.motion.table import write_csv
from sinuous.problem.asked import read_asked
from sinuous.problem.goals import KEYS, GoalArrays
from sinuous.problem.problem import Problem
from sinuous.problem.target import Targets
from sinuous.robot.robot import Robot
from sinuous.scene.scene import SceneLike
from sinuous.solution.solution import Solution
from sinuous.solution.status import Status
from sinuous.solving.between import Steps, prove_steps, unproved
from sinuous.solving.options import SolveArguments
from sinuous.solving.solver import Initial, Solver

if TYPE_CHECKING:
    from sinuous.solution.verification import Verification

MOST_WAYPOINTS = 1_000_000

Between = Literal["proved", "unproved"]
"""What is known of the motion between waypoints: all of it is proved clear, or some step is not."""


@dataclass(frozen=True, eq=False, repr=False)
class Track:
    """What following a path found, in the order of its waypoints; frozen.

    Attributes
    ----------
    solutions : tuple of Solution
        One for each waypoint that was tried.
    remaining : int
        Waypoints that were never tried, because the work was interrupted.
    """

    solutions: tuple[Solution, ...]
    remaining: int = 0

    @property
    def status(self) -> Status:
        """`solved` when every waypoint is; else the first other status, `time_limit` when waypoints were not tried."""
        unsolved = next((solution.status for solution in self.solutions if not solution.solved), None)
        if unsolved is not None:
            return unsolved
        return Status.TIME_LIMIT if self.remaining else Status.SOLVED

    @property
    def solved(self) -> bool:
        """Whether every waypoint is solved."""
        return self.status is Status.SOLVED

    @property
    def q(self) -> Floats:
        """Configurations (T, n, 3), one a waypoint."""
        return np.stack([solution.q for solution in self.solutions])

    @property
    def seconds(self) -> float:
        """Time of all solves together."""
        return sum(solution.seconds for solution in self.solutions)

    @property
    def clearance(self) -> float | None:
        """Least proved clearance, over the waypoints and, where it is proved, over the motion between them.

        `None` without obstacles, or when a waypoint has no proof.
        """
        return _least([solution.clearance for solution in self.solutions], self.steps.clearance)

    @property
    def self_clearance(self) -> float | None:
        """Least proved self-clearance, as for `clearance`; `None` where it does not matter, or without a proof."""
        return _least([solution.self_clearance for solution in self.solutions], self.steps.self_clearance)

    @property
    def largest_step(self) -> tuple[float, float]:
        """Largest change of a bending vector (rad) and of a length between neighbouring waypoints."""
        if len(self.solutions) < 2:
            return 0.0, 0.0
        steps = np.diff(self.q, axis=0)
        return float(np.hypot(steps[..., 0], steps[..., 1]).max()), float(np.abs(steps[..., 2]).max())

    @property
    def between(self) -> Between:
        """What is known of the motion between waypoints: `proved` clear all the way, or `unproved`."""
        return "unproved" if self.unproved_steps or not self.solved else "proved"

    @property
    def unproved_steps(self) -> tuple[int, ...]:
        """Numbers of the steps that are not proved; step 1 leads from the first waypoint to the second."""
        return tuple((np.flatnonzero(~self.steps.proved) + 1).tolist())

    @property
    def steps(self) -> Steps:
        """What is proved of the motion, linear in q, from each waypoint to the next; found when it is asked for."""
        if not hasattr(self, "_steps"):
            object.__setattr__(self, "_steps", _prove(self.solutions))
        found: Steps = self._steps  # type: ignore[attr-defined]
        return found

    def verify(self) -> "list[Verification]":
        """Recompute every waypoint by an independent, slow path."""
        return [solution.verify() for solution in self.solutions]

    def raise_for_status(self) -> "Track":
        """Return this track when every waypoint is solved.

        Raises
        ------
        NotSolvedError
            When one is not.
        """
        if not self.solved:
            raise NotSolvedError(str(self), self)
        return self

    @classmethod
    def from_dict(cls, values: Mapping[str, Any], problems: Iterable[Problem]) -> "Track":
        """Make a track of its result as plain values, and of the problems of its waypoints, one after the other.

        Raises
        ------
        InputError
            When `values` are no result of a track, or one of another number of waypoints.
        """
        asked = tuple(problems)
        listed = values.get("waypoints") if isinstance(values, dict) else None
        if not isinstance(listed, list) or not listed:
            raise InputError("waypoints", "", listed, "a list of results")
        remaining = checks.integer("remaining", values.get("remaining", 0), 0, MOST_WAYPOINTS)
        if len(listed) + remaining != len(asked):
            raise InputError("waypoints", "", len(listed) + remaining, f"as many as in the problem: {len(asked)}")
        solutions = []
        for i, (one, problem) in enumerate(zip(listed, asked, strict=False)):
            with checks.inside(f"waypoints[{i}]"):
                solutions.append(Solution.from_dict(one, problem))
        return cls(tuple(solutions), remaining)

    def to_dict(self) -> dict[str, Any]:
        """Return the totals and the waypoints as plain values, in the order of the file format."""
        waypoints = [solution.to_dict() for solution in self.solutions]
        first = waypoints[0]
        bend, length = self.largest_step
        return {
            "status": str(self.status),
            "base": first["base"],
            "position_error": _largest(waypoints, "position_error"),
            "angle_error": _largest(waypoints, "angle_error"),
            "clearance": self.clearance,
            "self_clearance": self.self_clearance,
            "worst": next((w["worst"] for w in waypoints if w["worst"] is not None), None),
            "reason": next((w["reason"] for w in waypoints if w["reason"] is not None), None),
            "binding": next((w["binding"] for w in waypoints if w["binding"]), []),
            "iterations": sum(w["iterations"] for w in waypoints),
            "starts": sum(w["starts"] for w in waypoints),
            "seconds": self.seconds,
            "method": first["method"],
            "seed": first["seed"],
            "between": self.between,
            "unproved_steps": list(self.unproved_steps),
            "largest_step": {"bend": bend, "length": length},
            "remaining": self.remaining,
            "waypoints": waypoints,
        }

    def save_csv(self, file: str | Path) -> None:
        """Write configurations and the values of all actuators as CSV, one row a waypoint.

        Columns: `waypoint` (1 = first), `status`, `bend_x`, `bend_y`, `length` of every segment (`s1.bend_x`), every
        actuator by its name.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        write_csv(file, self.solutions)

    def __len__(self) -> int:
        return len(self.solutions)

    def __repr__(self) -> str:
        solved = sum(solution.solved for solution in self.solutions)
        counted = f"{solved} of {len(self) + self.remaining} waypoints solved"
        return call("Track", [str(self.status), counted, f"{1e3 * self.seconds:.3g} ms"])

    def __str__(self) -> str:
        bend, length = self.largest_step
        times = np.array([solution.seconds for solution in self.solutions])
        parts = [f"Track: {self.status} ({self._sentence()})"]
        if self.clearance is not None:
            where = "all the way" if self.between == "proved" else "at the waypoints"
            parts.append(f"  clearance  {self.clearance:.3g} {where}")
        if self.between == "unproved" and len(self) > 1:
            parts.append(f"  between    {len(self.unproved_steps)} of {len(self) - 1} steps are not proved clear")
        parts.append(f"  steps      at most {bend:.3g} rad of bend and {length:.3g} of length")
        parts.append(f"  effort     {1e3 * self.seconds:.3g} ms, median {1e6 * np.median(times):.0f} us a waypoint")
        return "\n".join(parts)

    def _sentence(self) -> str:
        solved = sum(solution.solved for solution in self.solutions)
        counted = f"{solved} of {len(self) + self.remaining} waypoints"
        failed = next((i for i, solution in enumerate(self.solutions) if not solution.solved), None)
        if failed is None:
            return counted
        reason = self.solutions[failed].worst or self.solutions[failed].sentence
        return f"{counted}; waypoint {failed + 1}: {reason}"


class TrackArguments(SolveArguments, GoalArrays, total=False):
    """Options of `track` as keyword arguments, and arrays of goals."""


def track(
    robot: Robot,
    targets: Iterable[Targets] | None = None,
    scene: SceneLike | None = None,
    *,
    start: Initial | None = None,
    progress: Callable[[Solution], object] | None = None,
    **options: Unpack[TrackArguments],
) -> Track:
    """Follow a path of targets.

    Parameters
    ----------
    robot : Robot
    targets : iterable of Target or list of Target, optional
        The waypoints; the targets of a list are met at once. Or arrays of the tip's goals: `positions`, `directions`,
        `rotations` and `xyzw`, as for `Solver.solve_many`.
    scene : Scene or list of obstacles, optional
    start : Solution or array_like (n, 3), optional
        Where the first waypoint begins.
    progress : callable, optional
        Called with the solution of each waypoint as it is found.
    **options
        As for `Solver`; `time` is the budget of one waypoint.

    Returns
    -------
    Track
        Always; look at its status.

    Raises
    ------
    InputError
        When an argument is not what it should be; nothing is solved then.
    """
    given: dict[str, Any] = dict(options)
    path = read_asked(robot, targets, {key: given.pop(key) for key in KEYS if key in given})
    checks.integer("len(targets)", len(path), 1, MOST_WAYPOINTS)
    solver = Solver(robot, scene, **given)
    solutions = []
    for solution in waypoints(solver, map(path.targets, range(len(path))), start):
        solutions.append(solution)
        if progress is not None:
            progress(solution)
    return Track(tuple(solutions))


def waypoints(solver: Solver, path: Iterable[Targets], start: Initial | None = None) -> Iterator[Solution]:
    """Solve one waypoint after the other, each from the last that was solved, and yield what is found at once."""
    for targets in path:
        solution = solver.solve(targets, start)
        if solution.solved:
            start = solution
        yield solution


def _largest(results: list[dict[str, Any]], key: str) -> float | None:
    return max((result[key] for result in results if result[key] is not None), default=None)


def _least(clearances: list[float | None], between: float | None) -> float | None:
    """The least of proved clearances; `None` when that of a waypoint is missing."""
    known = [value for value in clearances if value is not None]
    if not known or len(known) < len(clearances):
        return None
    return min(known) if between is None else min(*known, between)


def _prove(solutions: tuple[Solution, ...]) -> Steps:
    """Prove the steps between waypoints that are solved, in a scene that did not change meanwhile."""
    answers = []
    for run in _runs(solutions):
        first = solutions[run.start].problem
        knots = np.stack([solutions[i].q for i in run])
        answers += [prove_steps(first.robot, first.scene, knots).answers, unproved(1)]
    return Steps(np.concatenate(answers)[: len(solutions) - 1])


def _runs(solutions: tuple[Solution, ...]) -> Iterator[range]:
    """Split waypoints into runs of neighbours that are solved, in the same scene; what is not solved stands alone."""
    begin = 0
    for i, (one, other) in enumerate(pairwise(solutions), 1):
        if not (one.solved and other.solved and one.problem.scene is other.problem.scene):
            yield range(begin, i)
            begin = i
    yield range(begin, len(solutions))
