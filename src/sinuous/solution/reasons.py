"""Why there is no solution: the number that proves it. Computed apart from the kernels that found the verdict."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sinuous.checks import Floats

if TYPE_CHECKING:
    from sinuous.problem.problem import Problem
    from sinuous.problem.target import Target
    from sinuous.robot.robot import Robot


@dataclass(frozen=True)
class Reason:
    """A bound that no configuration can keep.

    Attributes
    ----------
    bound : str
        `length`: the target is farther away than the robot is long. `near`: it is nearer than lengths and bends allow.
        `aside`, `behind`: it lies farther aside of the base's tangent, or less far ahead, than bends and lengths reach.
        `turning`: the direction asks for more than all bends together. `target`, `base`: the body needs more room
        there than the obstacle leaves. `route`: no way from mount to target is wide enough.
    needed, available : float
        What the bound compares: lengths, for `turning` angles (rad), for `route` the radius of the body and the edge of
        the cubes that free space was divided into.
    obstacle : str or None
        The nearest one, by name, where obstacles are the reason.
    """

    bound: str
    needed: float
    available: float
    obstacle: str | None = None

    def __str__(self) -> str:
        at = "" if self.obstacle is None else f" at {self.obstacle}"
        if self.bound == "route":
            return f"no way for a body of radius {self.needed:.4g}, in cubes of {self.available:.3g};{at} it is closed"
        return f"{self.bound}{at}: {self.needed:.4g} needed, {self.available:.4g} available"


def unreachable(problem: "Problem") -> Reason | None:
    """The first bound on lengths and bends that a target breaks; `None` when all keep them."""
    robot, tolerance = problem.robot, problem.tolerance
    for target in problem.targets:
        last = len(robot) if target.segment is None else target.segment
        for reason in _bounds(robot, target, last, tolerance.position or 0.0, tolerance.angle):
            if reason.needed > reason.available:
                return reason
    return None


def target_in(problem: "Problem") -> Reason | None:
    """The target whose body would overlap an obstacle the most."""
    robot = problem.robot
    found: list[Reason] = []
    for target in problem.targets:
        last = len(robot) if target.segment is None else target.segment
        if target.position is None:
            continue
        place, loose = backbone_end(robot, target, last, problem.tolerance.angle)
        found.append(
            _room(problem, place, robot.radii[last - 1], loose + (problem.tolerance.position or 0.0), "target")
        )
    return max(found, key=lambda reason: reason.needed - reason.available, default=None)


def base_in(problem: "Problem") -> Reason:
    """The obstacle that the body overlaps where it leaves its mount."""
    robot = problem.robot
    place = robot.base[:3, 3] + robot.mount * robot.base[:3, 2]
    return _room(problem, place, min(robot.radii), 0.0, "base")


def closed_in(problem: "Problem", cell: float) -> Reason:
    """The obstacle nearest to a target that no way leads to; `cell` is the edge of the cubes that proved it."""
    robot = problem.robot
    place = next(target.position for target in reversed(problem.targets) if target.position is not None)
    nearest = problem.scene.name(int(problem.scene.nearest(place)))
    return Reason("route", min(robot.radii), cell, nearest)


def _room(problem: "Problem", place: Floats, radius: float, loose: float, bound: str) -> Reason:
    nearest = problem.scene.name(int(problem.scene.nearest(place)))
    return Reason(bound, radius, float(problem.scene.distance(place)) + loose, nearest)


def backbone_end(robot: "Robot", target: "Target", last: int, angle_tolerance: float) -> tuple[Floats, float]:
    """Where a target puts the end of its segment, and how far from there it may be because the tool can turn."""
    place: Floats = np.asarray(target.position)
    shift = robot.tool[:3, 3]
    reach = float(np.linalg.norm(shift))
    if last < len(robot) or reach == 0.0:
        return place, 0.0
    if target.rotation is None:
        return place, reach
    return place - target.rotation @ robot.tool[:3, :3].T @ shift, min(2.0, angle_tolerance) * reach


def _bounds(robot: "Robot", target: "Target", last: int, near: float, angle: float) -> Iterator[Reason]:
    segments = robot.segments[:last]
    low, high = (np.array([segment.length[i] for segment in segments]) for i in range(2))
    bends = np.array([min(s.max_bend, s.max_curvature * s.length[1]) if s.length[1] else 0.0 for s in segments])
    turning = float(bends.sum())
    axis = robot.base[:3, 2]
    own_tool = last == len(robot)
    if target.position is not None:
        place, loose = backbone_end(robot, target, last, angle)
        loose += near
        way = place - robot.base[:3, 3]
        far = float(np.linalg.norm(way))
        yield Reason("length", far - loose, float(high.sum()))
        if turning < math.pi:
            yield Reason("near", float(low.sum()) * math.cos(0.5 * turning), far + loose)
        yield from _cone(low, high, bends, way, axis, loose)
        tangent = target.direction if target.rotation is None else target.rotation[:, 2]
        if tangent is not None and not (own_tool and robot.tool[2, 2] != 1.0):
            swing = loose + min(2.0, angle) * far
            yield from _cone(low[::-1], high[::-1], bends[::-1], -way, -tangent, swing)
    if target.direction is not None and turning < math.pi:
        off = math.acos(np.clip(robot.tool[2, 2], -1.0, 1.0)) if own_tool else 0.0
        yield Reason("turning", math.acos(np.clip(axis @ target.direction, -1.0, 1.0)), turning + off + angle)


def _cone(low: Floats, high: Floats, bends: Floats, way: Floats, axis: Floats, loose: float) -> Iterator[Reason]:
    """How far aside of the tangent that it begins with a curve may end at most, and how far ahead at least."""
    turned = np.concatenate([[0.0], np.cumsum(bends)])
    sine = _mean(lambda t: np.sin(np.minimum(t, 0.5 * math.pi)), turned)
    cosine = _mean(lambda t: np.cos(np.minimum(t, math.pi)), turned)
    ahead = float(way @ axis)
    yield Reason("aside", float(np.linalg.norm(way - ahead * axis)) - loose, float(high @ sine))
    yield Reason("behind", float(np.where(cosine > 0.0, low, high) @ cosine), ahead + loose)


def _mean(function: Callable[[Floats], Floats], ends: Floats) -> Floats:
    """Mean of a function between neighbouring ends, by Gauss's rule on pieces of the intervals."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    pieces = (np.arange(64)[:, None] + 0.5 * (nodes + 1.0)) / 64.0
    at = ends[:-1, None, None] + np.diff(ends)[:, None, None] * pieces
    result: Floats = (function(at) @ weights).sum(axis=-1) / 128.0
    return result
