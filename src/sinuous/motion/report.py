"""How a motion was found, and motions as plain values: what a result file says, and back."""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.answer.solve_again import Entries
from sinuous.answer.status import Status
from sinuous.answer.worst import Worst
from sinuous.base import checks
from sinuous.base.arguments import Reconfigure
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.certificate.query import ANSWER_WIDTH
from sinuous.model.robot import Robot, demanding
from sinuous.problem.problem import Problem
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import Steps

RECONFIGURE: tuple[Reconfigure, ...] = ("refuse", "allow")
"""What may be said of leaving a line."""

MOST_WAYPOINTS = 1_000_000
MOST_KNOTS = 10_000_000


@dataclass(frozen=True)
class Report:
    """How a motion was found.

    Attributes
    ----------
    solutions, waypoint_knots, reconfigured, reconfigure, remaining, seconds, method, seed
        As for `Motion`.
    deviation : float
        How far the tip may be from the line between waypoints (length unit).
    ended : Status or None
        How it ended, where solutions and steps do not say it.
    blocking : Worst or None
        The constraint that is farthest from being met then.
    notes : tuple of str
        As for `Motion`.
    """

    solutions: tuple[Solution, ...] = ()
    waypoint_knots: tuple[int | None, ...] = ()
    reconfigured: tuple[int, ...] = ()
    reconfigure: Reconfigure = "allow"
    deviation: float = math.inf
    remaining: int = 0
    seconds: float = 0.0
    method: str = "newton"
    seed: int = 0
    ended: Status | None = None
    blocking: Worst | None = None
    notes: tuple[str, ...] = ()


class MotionParts(NamedTuple):
    """What a motion is made of; see `Motion.made`."""

    robot: Robot
    scene: Snapshot
    q: Floats
    times: Floats
    steps: Steps
    found: Report


def read(
    values: Any,
    problems: tuple[Problem, ...],
    place: tuple[Robot, Snapshot] | None = None,
    scene: Snapshot | None = None,
    asked: int | None = None,
) -> MotionParts:
    """Read plain values and the problems of the waypoints of a motion; see `Motion.from_dict`.

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
    given = entries.value("knots")
    whole = robot.configuration("knots", given, entries.value("joints")) if robot.joints and len(given) else given
    q = checks.rows("knots", whole, len(robot), 3)
    times = checks.increasing("times", entries.value("times"), len(q))
    clearance, own = (entries.optional(key) for key in ("clearance", "self_clearance"))
    wrong = _read_numbers(values, "unproved_steps", len(q) - 1)
    steps = _read_steps(values, len(q) - 1, robot)
    steps = steps or Steps.told(max(0, len(q) - 1), wrong, clearance, own, robot._least_clearances)
    report = Report(
        solutions=tuple(solutions),
        waypoint_knots=_read_knots(values, len(solutions), len(q)),
        reconfigured=tuple(_read_numbers(values, "reconfigured", count)),
        reconfigure=checks.choice("reconfigure", values.get("reconfigure", "allow"), RECONFIGURE),
        deviation=math.inf if values.get("deviation") is None else entries.number("deviation", low=0.0),
        remaining=count - len(solutions),
        seconds=entries.number("seconds", low=0.0),
        method=entries.text("method"),
        seed=entries.integer("seed", 2**31 - 1),
    )
    return MotionParts(robot, around, q, times, steps, report)


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
    return Steps(known, robot._least_clearances)


def _at_their_times(values: dict[str, Any], problems: tuple[Problem, ...], scene: Snapshot) -> tuple[Problem, ...]:
    """Ask each problem in the scene as it is when its waypoint was reached; of one that was not, at the last time."""
    times, knots = map(Entries(values).items, ("times", "waypoint_knots"))
    ends = [times[knot] if isinstance(knot, int) and 0 <= knot < len(times) else times[-1] for knot in knots if times]
    when = [*ends, *[times[-1] if times else 0.0] * (len(problems) - len(ends))]
    return tuple(problem.changed(scene=scene.at(t)) for problem, t in zip(problems, when, strict=False))


def read_end(values: dict[str, Any]) -> tuple[Status, Worst | None]:
    """Read how a motion ended, and the constraint that was farthest from being met then."""
    status = Status(checks.choice("status", Entries(values).value("status"), tuple(Status)))
    return status, None if values.get("worst") is None else Worst.from_dict(values["worst"])


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
