"""How far ends are from their targets, and bounds on where a robot can reach, from its lengths and bends alone."""

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from sinuous.base.arguments import BoundName
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.problem.target import Target, Tolerance


def target_errors(robot: Robot, target: Target, ends: Floats) -> tuple[float, float]:
    """Distance to the target's position and angle (rad) to its orientation; 0 where nothing is asked."""
    last = robot.end_row(target.segment)
    pose = ends[-1] @ robot.tool if last == len(robot) else ends[last]
    off = turn = 0.0
    if target.position is not None:
        off = float(np.linalg.norm(pose[:3, 3] - target.position))
    if target.direction is not None:
        turn = angle_between(pose[:3, 2], target.direction)
    elif target.rotation is not None:
        # The chord between two rotations is 2 sqrt(2) sin(angle / 2); this keeps small angles exact.
        chord = float(np.linalg.norm(pose[:3, :3] - target.rotation)) / (2.0 * math.sqrt(2.0))
        turn = 2.0 * math.asin(min(1.0, chord))
    return off, turn


def angle_between(one: Floats, other: Floats) -> float:
    """Angle (rad) between two unit vectors (3,); exact for any angle."""
    return 2.0 * math.atan2(float(np.linalg.norm(one - other)), float(np.linalg.norm(one + other)))


def backbone_end(robot: Robot, target: Target, last: int, angle_tolerance: float) -> tuple[Floats, float]:
    """Where a target puts the end of row `last` (1 = first), and how far from there it may be as the tool can turn."""
    place: Floats = np.asarray(target.position)
    shift = robot.tool[:3, 3]
    reach = float(np.linalg.norm(shift))
    if last < len(robot) or reach == 0.0:
        return place, 0.0
    if target.rotation is None:
        return place, reach
    return place - target.rotation @ robot.tool[:3, :3].T @ shift, min(2.0, angle_tolerance) * reach


class Bound(NamedTuple):
    """What a target needs and the robot has; no configuration gets there when `needed` is greater than `available`.

    Attributes
    ----------
    name : str
        See `sinuous.answer.status.Reason`.
    needed, available : float
        Lengths; for `turning` angles (rad).
    pointing : bool
        Whether it comes of the direction that is asked for: seen from the target, back to the base.
    """

    name: BoundName
    needed: float
    available: float
    pointing: bool = False


def bounds(robot: Robot, target: Target, tolerance: Tolerance) -> Iterator[Bound]:
    """Yield what a target asks for, and what the lengths and bends of the segments before it allow at most."""
    last = robot.end_row(target.segment)
    near, angle = tolerance.position or 0.0, tolerance.angle
    segments = robot.rows[:last]
    low, high = (np.array([segment.length[i] for segment in segments]) for i in range(2))
    bends = np.array(
        [
            min(b, c * s.length[1]) if s.length[1] else 0.0
            for s, c, b in zip(segments, robot.curvatures, robot.largest_bends, strict=False)
        ]
    )
    turning = float(bends.sum())
    axis = robot.base[:3, 2]
    tilt = _tilt(robot.tool) if last == len(robot) else 0.0
    if target.position is not None:
        place, loose = backbone_end(robot, target, last, angle)
        loose += near
        chord = place - robot.base[:3, 3]
        far = float(np.linalg.norm(chord))
        yield Bound("length", far - loose, robot.longest_up_to(last))
        if segments[0].rigid:
            return
        if turning < math.pi:
            yield Bound("near", float(low.sum()) * math.cos(0.5 * turning), far + loose)
        yield from _cone(low, high, bends, chord, axis, loose)
        tangent = target.direction if target.rotation is None else target.rotation[:, 2]
        if tangent is not None:
            # The curve is moved by what the place may be off, and turned about it by what the tangent may.
            swing = loose + min(2.0, angle + tilt) * (far + loose)
            backwards = _cone(low[::-1], high[::-1], bends[::-1], -chord, -tangent, swing)
            yield from (bound._replace(pointing=True) for bound in backwards)
    if target.direction is not None and turning < math.pi and not segments[0].rigid:
        yield Bound("turning", angle_between(axis, target.direction), turning + tilt + angle)


def _tilt(tool: Floats) -> float:
    """By how much (rad) the z axis of a tool (4, 4) is tilted against the tangent of the body; exact for any angle."""
    return math.atan2(math.hypot(tool[0, 2], tool[1, 2]), tool[2, 2])


def _cone(low: Floats, high: Floats, bends: Floats, chord: Floats, axis: Floats, loose: float) -> Iterator[Bound]:
    """How far aside of the tangent that it begins with a curve may end at most, and how far ahead at least."""
    turned = np.concatenate([[0.0], np.cumsum(bends)])
    sine = _mean(lambda t: np.sin(np.minimum(t, 0.5 * math.pi)), turned)
    cosine = _mean(lambda t: np.cos(np.minimum(t, math.pi)), turned)
    ahead = float(chord @ axis)
    yield Bound("aside", float(np.linalg.norm(chord - ahead * axis)) - loose, float(high @ sine))
    yield Bound("behind", float(np.where(cosine > 0.0, low, high) @ cosine), ahead + loose)


def _mean(function: Callable[[Floats], Floats], ends: Floats) -> Floats:
    """Mean of a function between neighbouring ends, by Gauss's rule on pieces of the intervals."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    pieces = (np.arange(64)[:, None] + 0.5 * (nodes + 1.0)) / 64.0
    at = ends[:-1, None, None] + np.diff(ends)[:, None, None] * pieces
    return (function(at) @ weights).sum(axis=-1) / 128.0
