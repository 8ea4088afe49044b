"""Walls: thick ones with openings that are not round, and a cell within a cell."""

import math

import numpy as np
from numpy.random import Generator

from benchmarks.places.around.plates import largest_half
from benchmarks.places.parts.shapes import curve_of, draw_shape
from benchmarks.places.parts.surfaces import Surface, ring_loft, solid
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.places.traps.cells import cell_around, doorway, draw_half, in_frame, line_of
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.meshes.mesh import Mesh

WALLS, THICKNESS = (1, 3), (0.5, 4.0)
"""How many walls there are, and how thick."""

HOLE, SLOT, SLOT_END = 1.4, 0.5, (2.5, 5.0)
"""Radius of the round part of a keyhole, half the width of its slot, and how far from the middle that ends."""

SMALLEST = 8.0
"""Half the edge of a wall at least."""

APART = 4.0
"""Distance of the shape from itself. All lengths are in radii of the body."""

SIDES = 48

INNER, OUTER = (0.15, 0.4), (0.55, 0.8)
"""Where the shape leaves the inner and the outer cell, of its length."""


def keyholes(robot: Robot, rng: Generator) -> Sketch | None:
    """Put thick walls across the shape, each with an opening like a keyhole."""
    radius = max(robot.radii)
    q = draw_shape(robot, APART * radius, rng)
    curve, count = curve_of(robot, q, 40), int(rng.integers(WALLS[0], WALLS[1] + 1))
    walls: list[Mesh] = []
    for share in 0.2 + 0.7 * (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count:
        at = doorway(curve.poses[round(share * (len(curve.poses) - 1))], rng)
        half = largest_half(curve, at, radius)
        if half < SMALLEST * radius:
            return None
        thickness, end = radius * rng.uniform(*THICKNESS), radius * rng.uniform(*SLOT_END)
        walls.append(solid(_keyhole(at, half, thickness, radius, end), f"wall {len(walls) + 1}"))
    return sketch_of(robot, walls, q, rng)


def nested(robot: Robot, rng: Generator) -> Sketch | None:
    """Put the base into a cell within a larger cell, each with a door of its own; the target is outside."""
    q = draw_shape(robot, APART * max(robot.radii), rng)
    line = line_of(robot, q)
    first, second = (round(rng.uniform(*share) * (len(line.poses) - 1)) for share in (INNER, OUTER))
    inner_door, outer_door = doorway(line.poses[first], rng), doorway(line.poses[second], rng)
    inner = cell_around(line.before(first), inner_door, draw_half(line.radius, rng), line.radius, rng)
    outer = cell_around(line.before(second), outer_door, draw_half(line.radius, rng), line.radius, rng)
    if inner is None or outer is None or not inner.keeps_out(line.after(first), line.radius):
        return None
    low, high = inner.low - inner.wall, np.append(inner.high[:2] + inner.wall, 0.0)
    corners = np.stack(np.meshgrid(*np.stack([low, high], axis=1), indexing="ij"), axis=-1).reshape(-1, 3)
    within = in_frame(outer_door, corners @ inner_door[:3, :3].T + inner_door[:3, 3])
    spare = 3.0 * line.radius
    if within[:, 2].max() > outer.high[2]:
        return None
    lower, upper = np.minimum(outer.low, within.min(axis=0) - spare), outer.high.copy()
    upper[:2] = np.maximum(upper[:2], within.max(axis=0)[:2] + spare)
    outer = outer._replace(low=lower, high=upper)
    if not outer.keeps_out(line.after(second), line.radius):
        return None
    return sketch_of(robot, [*inner.boxes("inner cell"), *outer.boxes("outer cell")], q, rng)


def _keyhole(at: Floats, half: float, thickness: float, radius: float, end: float) -> Surface:
    """A square wall across the z axis of a frame (4, 4), with a hole whose slot leads along x."""
    turn = 2.0 * math.pi * np.arange(SIDES) / SIDES
    ahead = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    square = half * ahead / np.abs(ahead).max(axis=1, keepdims=True)
    slot = np.minimum(end, SLOT * radius / np.maximum(np.abs(ahead[:, 1]), 1e-9))
    hole = np.where(ahead[:, 0] > 0.0, np.maximum(HOLE * radius / math.cos(math.pi / SIDES), slot), 0.0)
    inner = np.maximum(hole, HOLE * radius / math.cos(math.pi / SIDES))[:, None] * ahead
    up, down = np.full((SIDES, 1), 0.5 * thickness), np.full((SIDES, 1), -0.5 * thickness)
    rings = [np.hstack([inner, down]), np.hstack([square, down]), np.hstack([square, up]), np.hstack([inner, up])]
    return ring_loft(np.stack(rings, axis=1) @ at[:3, :3].T + at[:3, 3]).turned
