"""How a motion was found, and motions as plain values: what a result file says, and back."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sinuous import checks
from sinuous.errors import InputError
from sinuous.kernels.between.query import ANSWER_WIDTH
from sinuous.problem.problem import Problem
from sinuous.robot.robot import Robot, demanding
from sinuous.scene.scene import entries_of
from sinuous.scene.snapshot import Snapshot
from sinuous.solution.reading import Entries
from sinuous.solution.solution import Solution, finite_or_none
from sinuous.solution.status import Status
from sinuous.solution.worst import Worst
from sinuous.solving.between.steps import Steps
from sinuous.writing.plain import described

if TYPE_CHECKING:
    from sinuous.motion.motion import Motion

MOST_WAYPOINTS = 1_000_000
MOST_KNOTS = 10_000_000


@dataclass(frozen=True)
class Report:
    """How a motion was found.

    Attributes
    ----------
    solutions, waypoint_knots, reconfigured, remaining, seconds, method, seed
        As for `Motion`.
    ended : Status or None
        How it ended, where solutions and steps do not say it.
    blocking : Worst or None
        The constraint that is farthest from being met then.
    """

    solutions: tuple[Solution, ...] = ()
    waypoint_knots: tuple[int | None, ...] = ()
    reconfigured: tuple[int, ...] = ()
    remaining: int = 0
    seconds: float = 0.0
    method: str = "newton"
    seed: int = 0
    ended: Status | None = None
    blocking: Worst | None = None


def write(motion: "Motion") -> dict[str, Any]:
    """Return a motion as plain values; see `Motion.to_dict`."""
    waypoints = [solution.to_dict() for solution in motion.solutions]
    bend, length = motion.largest_step
    worst = motion.worst
    return {
        "status": str(motion.status),
        "base": motion.robot.base.tolist(),
        "position_error": _largest(waypoints, "position_error"),
        "angle_error": _largest(waypoints, "angle_error"),
        "clearance": finite_or_none(motion.clearance),
        "self_clearance": finite_or_none(motion.self_clearance),
        "demanded_clearance": motion.robot.clearance if np.any(motion.robot.clearance) else None,
        "demanded_self_clearance": motion.robot.self_clearance if np.any(motion.robot.self_clearance) else None,
        "worst": None if worst is None else worst.to_dict(),
        "reason": next((w["reason"] for w in waypoints if w["reason"] is not None), None),
        "binding": next((w["binding"] for w in waypoints if w["binding"]), []),
        "iterations": sum(w["iterations"] for w in waypoints),
        "starts": sum(w["starts"] for w in waypoints),
        "seconds": motion.seconds,
        "method": motion.method,
        "seed": motion.seed,
        "between": motion.between,
        "unproved_steps": list(motion.unproved_steps),
        "reconfigured": list(motion.reconfigured),
        "largest_step": {"bend": bend, "length": length},
        "remaining": motion.remaining,
        "times": motion.times.tolist(),
        "knots": motion.q.tolist(),
        "waypoint_knots": list(motion.waypoint_knots),
        "waypoints": waypoints,
    }


def saved(motion: "Motion", folder: Path) -> dict[str, Any]:
    """Return a motion with its robot, its scene and the questions of its waypoints; see `Motion.save`."""
    asked = [[described(target) for target in solution.problem.targets] for solution in motion.solutions]
    parts = {
        "robot": motion.robot.to_dict(),
        "scene": entries_of(motion.scene.obstacles, folder),
        "path": asked,
        "tolerance": described(motion.solutions[0].problem.tolerance) if asked else None,
        "motion": {**write(motion), "steps": [list(map(finite_or_none, row)) for row in motion.steps.answers.tolist()]},
    }
    return {key: value for key, value in parts.items() if value}


def read(
    kind: "type[Motion]",
    values: Any,
    problems: tuple[Problem, ...],
    place: tuple[Robot, Snapshot] | None = None,
    scene: Snapshot | None = None,
    asked: int | None = None,
) -> "Motion":
    """Make a motion of plain values and the problems of its waypoints; see `Motion.from_dict`.

    A motion to a configuration has no waypoints, and no problems: its robot and scene are given in their `place`. The
    `scene` is the one whose obstacles move, where they do. So many waypoints were `asked`; by default those of the
    problems.
    """
    entries = Entries(values)
    if scene is not None and scene.moves:
        problems = _at_their_times(values, problems, scene)
    count = len(problems) if asked is None else asked
    solutions = _read_waypoints(values, problems, place is None, count)
    robot, around = place or (problems[0].robot, scene or problems[0].scene)
    robot = demanding(robot, *(values.get(key) for key in ("demanded_clearance", "demanded_self_clearance")))
    q = checks.rows("knots", entries.value("knots"), len(robot), 3)
    times = checks.increasing("times", entries.value("times"), len(q))
    clearance, own = (entries.optional(key) for key in ("clearance", "self_clearance"))
    wrong = _read_numbers(values, "unproved_steps", len(q) - 1)
    steps = _read_steps(values, len(q) - 1, robot)
    steps = steps or Steps.told(max(0, len(q) - 1), wrong, clearance, own, robot.least_demanded)
    report = Report(
        solutions=tuple(solutions),
        waypoint_knots=_read_knots(values, len(solutions), len(q)),
        reconfigured=tuple(_read_numbers(values, "reconfigured", count)),
        remaining=count - len(solutions),
        seconds=entries.number("seconds", low=0.0),
        method=entries.text("method"),
        seed=entries.integer("seed", 2**31 - 1),
    )
    motion = kind.made(robot, around, q, times, steps, report)
    return _as_it_ended(motion, values, report)


def _read_steps(values: dict[str, Any], count: int, robot: Robot) -> Steps | None:
    """What a file of a motion says of each step; a result says it of all together."""
    if values.get("steps") is None:
        return None
    given = Entries(values).items("steps")
    rows = [[0.0 if value is None else value for value in row] if isinstance(row, list) else row for row in given]
    known = checks.rows("steps", rows or np.zeros((0, ANSWER_WIDTH)), ANSWER_WIDTH).copy()
    if len(known) != max(0, count):
        raise InputError("steps", "", len(known), f"one for each step: {max(0, count)}")
    known[np.array([[value is None for value in row] for row in given], np.bool_).reshape(known.shape)] = math.inf
    return Steps(known, robot.least_demanded)


def _at_their_times(values: dict[str, Any], problems: tuple[Problem, ...], scene: Snapshot) -> tuple[Problem, ...]:
    """Ask each problem in the scene as it is when its waypoint was reached; of one that was not, at the last time."""
    times, knots = map(Entries(values).items, ("times", "waypoint_knots"))
    ends = [times[knot] if isinstance(knot, int) and 0 <= knot < len(times) else times[-1] for knot in knots if times]
    when = [*ends, *[times[-1] if times else 0.0] * (len(problems) - len(ends))]
    return tuple(problem.changed(scene=scene.at(t)) for problem, t in zip(problems, when, strict=False))


def _as_it_ended(motion: "Motion", values: dict[str, Any], report: Report) -> "Motion":
    """Tell how it ended, where solutions and steps do not say the same."""
    status = Status(checks.choice("status", Entries(values).value("status"), tuple(Status)))
    worst = None if values.get("worst") is None else Worst.from_dict(values["worst"])
    if motion.status is status and (worst is None or motion.worst is not None):
        return motion
    ended = replace(report, ended=status, blocking=worst)
    return motion.made(motion.robot, motion.scene, motion.q, motion.times, motion.steps, ended)


def _read_waypoints(values: dict[str, Any], problems: tuple[Problem, ...], some: bool, asked: int) -> list[Solution]:
    listed = values.get("waypoints")
    if not isinstance(listed, list) or (some and not problems):
        raise InputError("waypoints", "", listed, "a list of results")
    remaining = checks.integer("remaining", values.get("remaining", 0), 0, MOST_WAYPOINTS)
    if len(listed) + remaining != asked or len(listed) > len(problems):
        raise InputError("waypoints", "", len(listed) + remaining, f"as many as in the problem: {asked}")
    solutions = []
    for i, (one, problem) in enumerate(zip(listed, problems, strict=False)):
        with checks.inside(f"waypoints[{i}]"):
            solutions.append(Solution.from_dict(one, problem))
    return solutions


def _read_numbers(values: dict[str, Any], key: str, count: int) -> list[int]:
    """Numbers of steps or waypoints, 1 = first."""
    return [checks.integer(f"{key}[{i}]", one, 1, max(1, count)) for i, one in enumerate(Entries(values).items(key))]


def _read_knots(values: dict[str, Any], waypoints: int, knots: int) -> tuple[int | None, ...]:
    listed = Entries(values).items("waypoint_knots")
    if len(listed) != waypoints:
        raise InputError("waypoint_knots", "", len(listed), f"as many as waypoints: {waypoints}")
    keys = [f"waypoint_knots[{i}]" for i in range(waypoints)]
    return tuple(
        None if one is None else checks.integer(key, one, 0, max(0, knots - 1))
        for key, one in zip(keys, listed, strict=True)
    )


def _largest(results: list[dict[str, Any]], key: str) -> float | None:
    return max((result[key] for result in results if result[key] is not None), default=None)
