"""Tubes that the tip lies in: the base in another tube, or before a mouth that widens like a funnel."""

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.shapes import Curve, curve_of, draw_shape, lengthened
from benchmarks.places.parts.surfaces import WALL, Surface, open_tube, solid, widening_tube
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.places.traps.cells import line_of
from benchmarks.places.traps.corridors import FLIP
from benchmarks.places.traps.pipes import RINGS, backwards
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot

WIDTH = (1.25, 2.5)
"""Inner radius of a tube."""

PAST = (1.2, 3.0)
"""How far a tube goes on beyond the tip, or the tool. Both in radii of the body."""

BLIND = 0.5
"""Share of the tubes about a target that are closed at the bottom."""

GAP_BEGINS, GAP_ENDS = (0.15, 0.45), (0.6, 0.85)
"""Where the tube of the base ends, and where that of the target begins, of the shape."""

FUNNEL_BEGINS, WIDENED, CONE = (0.3, 0.7), (1.5, 3.0), 0.25
"""Where a funnel begins, of the shape; how much wider it is there; and how much of it is a cone."""


def two_tubes(robot: Robot, rng: Generator) -> Sketch:
    """Put the base into one tube and the target into another, with the open between."""
    radius, (near, far) = max(robot.radii), rng.uniform(*WIDTH, 2)
    q, curve = _shape(robot, max(near, far), rng)
    last = len(curve.poses) - 1
    begin, end = round(rng.uniform(*GAP_BEGINS) * last), round(rng.uniform(*GAP_ENDS) * last)
    first = open_tube(backwards(curve.poses[: begin + 1], radius, rng), near * radius, (near + WALL) * radius)
    within = _past(robot, q, curve.poses[end:], rng)
    other = _around_target(within, far * radius, radius, rng)
    return sketch_of(robot, [solid(first, "base tube"), solid(other, "target tube")], q, rng)


def funnel(robot: Robot, rng: Generator) -> Sketch | None:
    """Put the target into a tube, open at both ends, whose mouth widens; the base is before it."""
    radius, width, widened = max(robot.radii), rng.uniform(*WIDTH), rng.uniform(*WIDENED)
    q, curve = _shape(robot, width * widened, rng)
    begin = round(rng.uniform(*FUNNEL_BEGINS) * (len(curve.poses) - 1))
    poses = _past(robot, q, curve.poses[begin:], rng)
    share = np.linspace(0.0, 1.0, len(poses))
    inside = width * radius * (1.0 + (widened - 1.0) * np.clip(1.0 - share / CONE, 0.0, 1.0))
    return sketch_of(robot, [solid(widening_tube(poses, inside, inside + WALL * radius), "funnel")], q, rng)


def _shape(robot: Robot, width: float, rng: Generator) -> tuple[Floats, Curve]:
    q = draw_shape(robot, 2.1 * (width + WALL) * max(robot.radii), rng)
    return q, curve_of(robot, q, RINGS)


def _past(robot: Robot, q: Floats, poses: Floats, rng: Generator) -> Floats:
    """Go on beyond the tip, and beyond the tool."""
    tool = line_of(robot, q).end - poses[-1, :3, 3]
    ahead = max(0.0, float(tool @ poses[-1, :3, 2]))
    return lengthened(poses, ahead + max(robot.radii) * rng.uniform(*PAST))


def _around_target(poses: Floats, inside: float, radius: float, rng: Generator) -> Surface:
    """The wall around frames (m, 4, 4) that the shape enters by the first one, closed at the last one or open."""
    if rng.random() >= BLIND:
        return open_tube(poses, inside, inside + WALL * radius)
    return open_tube(poses[::-1] @ FLIP, inside, inside + WALL * radius, bottom=True)
