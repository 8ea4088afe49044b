"""A drum with rows of blades, as in an engine, and the target deep between two of them."""

import math

import numpy as np
from numpy.random import Generator

from benchmarks.places.parts.robots import robot_of
from benchmarks.places.parts.shapes import curve_of, draw_shape
from benchmarks.places.parts.surfaces import Surface, joined, loft, solid
from benchmarks.places.place import Sketch
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Cylinder, Obstacle

GAP = (2.8, 3.6)
"""Distance of neighbouring blades, from middle to middle, at the tip."""

HEIGHT, WIDTH, HUB = (6.0, 12.0), (5.0, 9.0), (6.0, 12.0)
"""Of a blade, along the radius and along the axis; radius of the drum. All in radii of the body."""

THICKNESS = 0.5
TWIST = (-0.25, 0.25)
"""By how much a blade turns about the radius from root to end, rad."""

ROWS = (1, 3)
STEPS = 6
"""Pieces of a blade from root to end."""


def drum(seed: int, rng: Generator) -> Sketch | None:
    """Stand the drum before the hidden tip, its axis in the plane that the tip bends in, and grow blades around it."""
    robot = robot_of(seed, rng)
    radius = min(robot.radii)
    q = draw_shape(robot, 4.0 * radius, rng)
    tip = curve_of(robot, q, 2).poses[-1]
    outwards = -tip[:3, 2]
    axis = tip[:3, :2] @ (q[-1, :2] / np.linalg.norm(q[-1, :2]))
    hub = radius * rng.uniform(*HUB)
    height, width = radius * rng.uniform(*HEIGHT), radius * rng.uniform(*WIDTH)
    above = radius * rng.uniform(1.2, 2.0)
    center = tip[:3, 3] - outwards * (hub + above)
    count = int(2.0 * math.pi * (hub + above) / (radius * rng.uniform(*GAP)))
    twist = rng.uniform(*TWIST)
    # Rows lie on either side of the one with the target, and the target's is not always in the middle of it.
    middle = rng.uniform(-0.3, 0.3) * width
    rows, before = int(rng.integers(*ROWS)), int(rng.integers(0, 2))
    frame = np.stack([outwards, np.cross(axis, outwards), axis], axis=-1)
    pitch = width + 1.5 * radius
    obstacles: list[Obstacle] = [_hub(center, axis, hub, middle, pitch, rows)]
    for row in range(rows):
        lift = middle + (row - min(before, rows - 1)) * pitch
        first = 0.5 if row == min(before, rows - 1) else rng.random()
        blades = [
            _blade(2.0 * math.pi * (j + first) / count, hub, height, width, lift, THICKNESS * radius, twist)
            for j in range(count)
        ]
        placed = joined(blades)
        surface = Surface(placed.vertices @ frame.T + center, placed.faces)
        obstacles.append(solid(surface, f"blades {row + 1}"))
    return Sketch(robot, obstacles, q)


def _hub(center: Floats, axis: Floats, radius: float, middle: float, pitch: float, rows: int) -> Cylinder:
    half = (abs(middle) + rows * pitch) * axis
    return Cylinder(center - half, center + half, radius, name="drum")


def _blade(
    angle: float, hub: float, height: float, width: float, lift: float, thickness: float, twist: float
) -> Surface:
    """One blade about the z axis, with its root a little in the drum."""
    shares = np.linspace(0.0, 1.0, STEPS + 1)
    corners = 0.5 * np.array([[-thickness, -width], [thickness, -width], [thickness, width], [-thickness, width]])
    rings = []
    for share in shares:
        turned = corners @ np.array(_turn(twist * share)).T
        ring = np.stack([np.full(4, 0.98 * hub + share * height), turned[:, 0], lift + turned[:, 1]], axis=-1)
        rings.append(ring @ _about_z(angle).T)
    stacked = np.array(rings)
    return loft(stacked, stacked[[0, -1]].mean(axis=1))


def _turn(angle: float) -> list[list[float]]:
    return [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]


def _about_z(angle: float) -> Floats:
    rotation = np.eye(3)
    rotation[:2, :2] = _turn(angle)
    return rotation
