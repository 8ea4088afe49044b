"""Places for robots of which it is a choice where they begin to bend: long insertion stages, and joints before the arm.

What is narrow is drawn about the bending part alone, as for a robot without a stage or joints that begins there.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges.kinematics import link_poses
from benchmarks.places import cells, tubes
from benchmarks.places.parts.robots import SLENDER
from benchmarks.places.parts.shapes import arc
from benchmarks.places.parts.surfaces import plate, solid
from benchmarks.places.place import Sketch, Trap
from sinuous.model.joints import Fixed, Joint

COUNTS, MOST_BEND = (2, 3, 5, 8), 2.2
"""Numbers of bending segments, in turn, and the largest bend of each (rad)."""

LENGTH = (0.08, 0.25)
"""Range of the length of a segment, in m: on a stage, and on joints."""

STAGE, PUSHED = (3.0, 50.0), (0.15, 0.9)
"""Longest insertion of a stage, in lengths of a segment; and how far it is in, of that."""

PORT, BEHIND_PORT = (0.05, 0.3), (0.4, 0.7)
"""Where a shape goes through a wall, and into a tube behind it, of its length."""

DEEP, DEEP_WIDTH = (0.02, 0.4), (1.25, 1.8)
"""Where a deep tube begins, of the shape, and its inner radius, in radii of the body."""


def deep(robot: sn.Robot, rng: Generator) -> Sketch:
    """Put the target deep into a bent tube, closed at the bottom or open."""
    radius, width = max(robot.radii), rng.uniform(*DEEP_WIDTH)
    q, curve = tubes.tube_shape(robot, width, rng)
    within = tubes.past(robot, q, curve.poses[round(rng.uniform(*DEEP) * (len(curve.poses) - 1)) :], rng)
    return Sketch(robot, [solid(tubes.around_target(within, width * radius, radius, rng), "tube")], q)


SLEEVE_BEGINS, SLEEVE_ENDS = (0.0, 0.15), (0.5, 0.95)
"""Where a sleeve begins and ends, of the shape."""


def sleeve(robot: sn.Robot, rng: Generator) -> Sketch:
    """Put a tube that is open at both ends about most of the shape: shorter ways to the target lead past it."""
    radius, width = max(robot.radii), rng.uniform(*DEEP_WIDTH)
    q, curve = tubes.tube_shape(robot, width, rng)
    begin, end = (round(rng.uniform(*share) * (len(curve.poses) - 1)) for share in (SLEEVE_BEGINS, SLEEVE_ENDS))
    return Sketch(robot, [tubes.walled(curve.poses[begin : end + 1], width, radius, "sleeve")], q)


def port(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put the target deep into a tube behind a wall with a port, larger than the robot is long."""
    radius, width = max(robot.radii), rng.uniform(*DEEP_WIDTH)
    q, curve = tubes.tube_shape(robot, width, rng)
    last = len(curve.poses) - 1
    door, begin = round(rng.uniform(*PORT) * last), round(rng.uniform(*BEHIND_PORT) * last)
    at = curve.poses[door]
    if cells.in_frame(at, curve.points[begin:])[:, 2].min() < 2.0 * width * radius:
        return None
    wall = plate(at, 2.0 * float(q[:, 2].sum()), width * radius, radius)
    within = tubes.past(robot, q, curve.poses[begin:], rng)
    tube = tubes.around_target(within, width * radius, radius, rng)
    return Sketch(robot, [solid(wall, "wall"), solid(tube, "tube")], q)


TRAPS: tuple[Trap, ...] = (deep, sleeve, port, cells.door_in, tubes.funnel)
"""What is narrow, in turn."""


def staged(seed: int, rng: Generator) -> Sketch | None:
    """Draw a trap for segments behind a long stage."""
    segments = _segments(seed, rng)
    base = sn.pose(rng.normal(size=3), rotation=rng.normal(size=4))
    sketch = _trap(seed)(sn.Robot(segments, base=base), rng)
    if sketch is None:
        return None
    longest = rng.uniform(*STAGE) * segments[0].length[1]
    pushed = np.array([0.0, 0.0, rng.uniform(*PUSHED) * longest])
    stage = sn.Segment((0.0, longest), max_bend=0.0, radius=segments[0].radius)
    robot = sn.Robot([stage, *segments], base=arc(base, -pushed, 1)[-1])
    return Sketch(robot, sketch.obstacles, np.vstack([pushed, sketch.q]))


def carried(joints: Callable[[Generator], list[Joint]], seed: int, rng: Generator) -> Sketch | None:
    """Draw a trap for segments behind joints."""
    robot = sn.Robot(_segments(seed, rng), joints=joints(rng))
    low, high = np.array([joint.limits for joint in robot.joints if not isinstance(joint, Fixed)]).T
    values = rng.uniform(low, high)
    mount = link_poses(robot, values[None])[0, -1]
    sketch = _trap(seed)(sn.Robot(robot.segments, base=mount), rng)
    return None if sketch is None else Sketch(robot, sketch.obstacles, robot.with_joints(sketch.q, values))


def six_axes(rng: Generator) -> list[Joint]:
    """An elbow robot of six axes, of any size."""
    upper, lower = rng.uniform(0.3, 0.6, 2)
    above, beyond = [((0, 0, 0.12), (0, 0, length - 0.1), 0.06) for length in (upper, lower)]
    axes = (
        ((0, 0, 1), 0.2, 2.9, ()),
        ((0, 1, 0), 0.15, 1.9, [above]),
        ((0, 1, 0), upper, 2.6, ()),
        ((0, 0, 1), 0.0, 2.9, [beyond]),
        ((0, 1, 0), lower, 2.0, ()),
        ((0, 0, 1), 0.0, 2.9, [((0, 0, 0.0), (0, 0, 0.06), 0.04)]),
    )
    moving = [sn.Revolute(axis, (-most, most), (0, 0, up), body=body) for axis, up, most, body in axes]
    return [*moving, Fixed((0, 0, 0.1))]


def driven(rng: Generator) -> list[Joint]:
    """A base that drives and turns, the arm at its front or on top of it."""
    body = [((-0.2, 0.0, 0.12), (0.2, 0.0, 0.12), 0.12)]
    axes = [sn.Prismatic((1, 0, 0), (-2, 2)), sn.Prismatic((0, 1, 0), (-2, 2)), sn.Revolute(body=body)]
    return [*axes, Fixed(sn.pose((0.2, 0.0, 0.3), direction=(1, 0, 0) if rng.random() < 0.5 else (0, 0, 1)))]


def railed(rng: Generator) -> list[Joint]:
    """A carriage on a rail, on which the arm is rolled; it stands across the rail, more or less."""
    lean = rng.uniform(-0.5, 0.5)
    carriage = sn.Prismatic((1, 0, 0), (0.0, rng.uniform(0.5, 2.0)), body=[((0, 0, 0), (0, 0, -0.05), 0.05)])
    return [carriage, sn.Revolute(origin=sn.pose((0, 0, 0.02), direction=(math.sin(lean), 0, math.cos(lean))))]


def _trap(seed: int) -> Trap:
    return TRAPS[seed // len(COUNTS) % len(TRAPS)]


def _segments(seed: int, rng: Generator) -> list[sn.Segment]:
    unit = rng.uniform(*LENGTH)
    radius = unit * rng.uniform(*SLENDER)
    length = (0.8 * unit, 1.2 * unit) if rng.random() < 0.5 else unit
    return [sn.Segment(length, MOST_BEND, radius=radius)] * COUNTS[seed % len(COUNTS)]
