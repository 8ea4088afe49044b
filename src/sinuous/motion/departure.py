"""Where the tip leaves the line between two waypoints, and how far, by dense sampling."""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.measures.body import segment_ends
from sinuous.measures.following import shares_between
from sinuous.model.robot import Robot
from sinuous.motion.knots import TipLine
from sinuous.problem.problem import ask_body
from sinuous.problem.target import Tolerance

TURNED = 10.0
"""How far the tip may be turned from the line before it has left that, in tolerances of angles."""

Tips = Callable[[Robot, Floats], Floats]
"""Computes the poses (T, 4, 4) of the tool in configurations (T, n, 3)."""


class Departure(NamedTuple):
    """How the tip left lines between waypoints.

    Attributes
    ----------
    steps : tuple of int
        Numbers of the steps in which it did, 1 = first.
    position, angle : float
        How far it was off, at most (length unit, rad).
    """

    steps: tuple[int, ...] = ()
    position: float = 0.0
    angle: float = 0.0


class Leg(NamedTuple):
    """The way from one waypoint that is solved to the next, which ask for the same of the tip.

    Attributes
    ----------
    waypoints : (int, int)
        Their numbers, 1 = first.
    knots : (int, int)
        Where they are reached, 0 = first.
    line : TipLine
    tolerance : Tolerance
    """

    waypoints: tuple[int, int]
    knots: tuple[int, int]
    line: TipLine
    tolerance: Tolerance


def legs_between(solutions: Sequence[Solution], waypoint_knots: Sequence[int | None]) -> Iterator[Leg]:
    """Return the ways from waypoint to waypoint on which the tip has a line to follow."""
    reached = [(i, knot) for i, knot in enumerate(waypoint_knots) if knot is not None]
    for (i, begin), (j, end) in pairwise(reached):
        one, other = (solutions[number].problem for number in (i, j))
        line = TipLine.between(one.targets, other.targets)
        if line is not None and begin < end:
            yield Leg((i + 1, j + 1), (begin, end), line, other.tolerance)


def find_departure(
    robot: Robot, q: Floats, legs: Iterator[Leg], most: float, tips: Tips, turned_most: float = TURNED
) -> Departure:
    """Look densely at ways through knots (T, n, 3), where the tip has lines to follow.

    It may be `most` off a line (length unit), and turned from it by so many tolerances of angles.
    """
    steps: list[int] = []
    position = angle = 0.0
    for leg in legs:
        begin, end = leg.knots
        for step in range(begin, end):
            shares = shares_between(robot, q[step], q[step + 1])
            between = (1.0 - shares)[:, None, None] * q[step] + shares[:, None, None] * q[step + 1]
            off, turned = off_line(leg.line, tips(robot, between))
            if off > most + (leg.tolerance.position or 0.0) or turned > turned_most * leg.tolerance.angle:
                steps.append(step + 1)
                position, angle = max(position, off), max(angle, turned)
    return Departure(tuple(steps), position, angle)


def off_line(line: TipLine, poses: Floats) -> tuple[float, float]:
    """How far poses (k, 4, 4) are off a line (length unit), and turned from it (rad), at most."""
    begin, end = line.begin.position, line.end.position
    assert begin is not None
    assert end is not None
    shares = line.shares_of(poses)
    off = np.linalg.norm(poses[:, :3, 3] - begin - shares[:, None] * (end - begin), axis=1)
    return float(off.max()), line.turned(poses, shares)


def tip_poses(robot: Robot, q: Floats) -> Floats:
    """Poses (T, 4, 4) of the tool (of the tip, without one) in configurations (T, n, 3), in the world."""
    if robot.has_external_load:
        return np.array([robot.shape(one).tip for one in q]).reshape(-1, 4, 4)
    return robot.tip(q)


def measured_tips(robot: Robot, q: Floats) -> Floats:
    """Return the same by the slow path, without kernels."""
    poses = []
    for one in q:
        asked = ask_body(robot, one, ())
        poses.append(segment_ends(asked.body, asked.arcs)[-1] @ asked.body.tool)
    return np.stack(poses)
