"""A duct of boxes with a rectangular section, bent in one plane to either side."""

import math
from itertools import pairwise

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.shapes import Curve, curve_of, keeps_from_itself
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.places.traps.boxes import box_between
from benchmarks.places.traps.cells import in_frame
from benchmarks.places.traps.pipes import RINGS, backwards
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Box

WIDTH = (1.25, 3.0)
"""Half of each side of the section."""

SHEET = 0.8
"""Thickness of the walls. Both in radii of the body."""

BENDS, TURNED, INSERTED = (0.1, 0.8), 0.35, (0.3, 1.0)
"""Bends, of the largest; share of segments from which on it bends to the other side; insertions, of the longest."""

BEGINS, ENDS, WITHIN = (0.1, 0.35), (0.5, 0.95), 0.6
"""Where a duct begins and ends, of the shape; and share of those that begin at the base."""

SHAPES, EVERY = 40, 3
"""Shapes drawn for one; and frames of the shape from one box of a wall to the next."""


def box_duct(robot: Robot, rng: Generator) -> Sketch | None:
    """Lead a duct around a flat shape, from the base or from a place beyond it."""
    radius, (width, height) = max(robot.radii), rng.uniform(*WIDTH, 2)
    found = _flat(robot, 2.2 * (width + SHEET) * radius, rng)
    if found is None:
        return None
    q, plane, curve = found
    last, at_base = len(curve.poses) - 1, rng.random() < WITHIN
    begin, end = 0 if at_base else round(rng.uniform(*BEGINS) * last), round(rng.uniform(*ENDS) * last)
    turn = np.eye(4)
    turn[:2, :2] = [[math.cos(plane), -math.sin(plane)], [math.sin(plane), math.cos(plane)]]
    poses = curve.poses[begin : end + 1 : EVERY] @ turn
    if at_base:
        poses = backwards(poses, radius, rng)
    return sketch_of(robot, _walls(poses, width * radius, height * radius, SHEET * radius), q, rng)


def _flat(robot: Robot, apart: float, rng: Generator) -> tuple[Floats, float, Curve] | None:
    """Draw a configuration (n, 3) that bends in one plane and keeps `apart` from itself; and that plane, rad."""
    low, high, most = np.array([(*segment.length, segment.max_bend) for segment in robot.segments]).T
    low = np.where(low == 0.0, INSERTED[0] * high, low)
    for _ in range(SHAPES):
        plane, side = rng.uniform(0.0, 2.0 * math.pi), np.cumprod(np.where(rng.random(len(robot)) < TURNED, -1.0, 1.0))
        bends = side * most * rng.uniform(*BENDS, len(robot))
        q = np.stack([bends * math.cos(plane), bends * math.sin(plane), rng.uniform(low, high)], axis=-1)
        curve = curve_of(robot, q, RINGS)
        if keeps_from_itself(curve, apart):
            return q, plane, curve
    return None


def _walls(poses: Floats, width: float, height: float, sheet: float) -> list[Box]:
    """Boxes along both sides of frames (m, 4, 4) whose x axes lie in the plane, and a floor and a ceiling."""
    boxes, points = list[Box](), poses[:, :3, 3]
    for side, name in ((-1.0, "left"), (1.0, "right")):
        edge = points + side * (width + 0.5 * sheet) * poses[:, :3, 0]
        for a, b in pairwise(edge):
            length = float(np.linalg.norm(b - a))
            along, normal = (b - a) / length, poses[0, :3, 1]
            size = sheet, 2.0 * height, length + 0.2 * sheet
            boxes.append(Box(0.5 * (a + b), size, np.column_stack([np.cross(normal, along), normal, along]), name=name))
    local = in_frame(poses[0], points)
    margin = width + sheet
    low, high = local.min(axis=0) - margin, local.max(axis=0) + margin
    for side, name in ((-1.0, "floor"), (1.0, "ceiling")):
        low[1], high[1] = sorted((side * height, side * (height + sheet)))
        boxes.append(box_between(poses[0], low.copy(), high.copy(), name))
    return boxes
