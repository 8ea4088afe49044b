"""Places of hundreds of parts: rods, sheets, hoops, trays of cables, frames of profiles, bodies of one STL."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.places.parts.shapes import Curve, curve_of, draw_shape
from benchmarks.places.parts.surfaces import joined, solid, tube
from benchmarks.places.place import Sketch, sketch_of
from sinuous.base.checks import Floats
from sinuous.measures.obstacles import measure
from sinuous.scene.obstacles import Obstacle

APART, LEEWAY, AROUND = 4.0, 1.2, 10.0
"""Distance of the shape from itself; least distance of parts from it; how far about it there are parts."""

PARTS, MADE = (200, 900), 4
"""How many parts there are in a place, at most; and how many are drawn for each of them."""

ROD, ROD_LENGTH = (0.08, 0.6), (6.0, 40.0)
"""Radius of rods, and their length."""

SHEET, SHEET_SIZE = (0.05, 0.25), (1.0, 7.0)
"""Half the thickness of sheets, and their edges."""

HOOP, HOOP_THICKNESS, HOOP_PARTS = (1.6, 6.0), (0.1, 0.4), (8, 14)
"""Radius of hoops, that of the bar they are bent of, and of how many capsules each is made."""

CABLE, CABLE_LENGTH, CABLE_PARTS, CABLE_BEND = (0.15, 0.5), (12.0, 40.0), (8, 18), 0.35
"""Radius of cables, length of a tray of them, of how many capsules each is made, and how much it turns from one to the
next, rad."""

CABLES, SAG = (4, 12), 0.3
"""Cables side by side on a tray, and how much each deviates from the next, in radii."""

PROFILE, PROFILE_LENGTH = (0.3, 1.0), (4.0, 20.0)
"""Edges of the section of profiles, and their length."""

BAR, BAR_LENGTH, BARS = (0.2, 0.9), (4.0, 25.0), (50, 150)
"""Radius of the bars of an assembly, their length, and how many are drawn. All lengths are in radii of the body."""

Part = tuple[list[Obstacle], Floats]
"""What stays or goes together, and points (m, 3) that tell where it is."""


def rods(robot: sn.Robot, rng: Generator) -> Sketch:
    """Throw straight rods around the shape, at random."""

    def rod(place: Floats, radius: float) -> list[Obstacle]:
        half = 0.5 * radius * rng.uniform(*ROD_LENGTH) * _way(rng)
        return [sn.Capsule(place - half, place + half, radius * rng.uniform(*ROD))]

    return _crowd(robot, rng, rod, 1)


def sheets(robot: sn.Robot, rng: Generator) -> Sketch:
    """Throw thin sheets around the shape: in half of the places they stand nearly parallel, as fins do."""
    common = rng.normal(size=4) if rng.random() < 0.5 else None

    def sheet(place: Floats, radius: float) -> list[Obstacle]:
        size = 2.0 * radius * np.array([*rng.uniform(*SHEET_SIZE, 2), rng.uniform(*SHEET)])
        return [sn.Box(place, size, rng.normal(size=4) if common is None else common + 0.1 * rng.normal(size=4))]

    return _crowd(robot, rng, sheet, 1)


def hoops(robot: sn.Robot, rng: Generator) -> Sketch:
    """Thread the shape through hoops, and hang more of them around it, each of capsules."""
    radius = max(robot.radii)

    def hoop(place: Floats, across: Floats) -> list[Obstacle]:
        count, thickness = int(rng.integers(*HOOP_PARTS)), radius * rng.uniform(*HOOP_THICKNESS)
        size = radius * rng.uniform(*HOOP) + thickness
        turns = 2.0 * math.pi * np.arange(count + 1) / count
        corners = place + size * (np.cos(turns)[:, None] * across[:, 0] + np.sin(turns)[:, None] * across[:, 1])
        return [sn.Capsule(a, b, thickness) for a, b in pairwise(corners)]

    def any_hoop(place: Floats, _: float) -> list[Obstacle]:
        return hoop(place, np.linalg.qr(rng.normal(size=(3, 3)))[0])

    def threaded(curve: Curve) -> list[Obstacle]:
        pose = curve.poses[rng.integers(len(curve.poses))]
        tilt = np.linalg.qr(pose[:3, :3] + 0.15 * rng.normal(size=(3, 3)))[0]
        return hoop(pose[:3, 3] + 0.3 * radius * rng.normal(size=3), tilt)

    return _crowd(robot, rng, any_hoop, HOOP_PARTS[1], threaded)


def cables(robot: sn.Robot, rng: Generator) -> Sketch:
    """Lead trays of curved cables past the shape."""

    def tray(place: Floats, radius: float) -> list[Obstacle]:
        count, parts, thickness = (
            int(rng.integers(*CABLES)),
            int(rng.integers(*CABLE_PARTS)),
            radius * rng.uniform(*CABLE),
        )
        step = radius * rng.uniform(*CABLE_LENGTH) / parts
        frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        ways = [frame[:, 0]]
        for _ in range(parts - 1):
            way = ways[-1] + CABLE_BEND * rng.normal(size=3)
            ways.append(way / np.linalg.norm(way))
        line = np.cumsum([np.zeros(3), *(step * np.array(ways))], axis=0)
        made: list[Obstacle] = []
        for i in range(count):
            own = place + line - line.mean(axis=0) + 2.2 * thickness * (i - 0.5 * count) * frame[:, 1]
            own = own + SAG * thickness * rng.normal(size=own.shape)
            made += [sn.Capsule(a, b, thickness) for a, b in pairwise(own)]
        return made

    return _crowd(robot, rng, tray, CABLES[1] * CABLE_PARTS[1])


def profiles(robot: sn.Robot, rng: Generator) -> Sketch:
    """Stand the shape in a frame of profiles: boxes and cylinders along three axes, and some that are oblique."""
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]

    def profile(place: Floats, radius: float) -> list[Obstacle]:
        length, oblique = radius * rng.uniform(*PROFILE_LENGTH), rng.random() < 0.2
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0] if oblique else np.roll(axes, int(rng.integers(3)), axis=1)
        turn = turn * np.sign(np.linalg.det(turn))
        if rng.random() < 0.5:
            size = np.array([*(2.0 * radius * rng.uniform(*PROFILE, 2)), length])
            return [sn.Box(place, size, turn)]
        half = 0.5 * length * turn[:, 2]
        return [sn.Cylinder(place - half, place + half, radius * rng.uniform(*PROFILE))]

    return _crowd(robot, rng, profile, 1)


def assembly(robot: sn.Robot, rng: Generator) -> Sketch:
    """Stand the shape among bars that are bodies of one mesh, as a reader of STL files divides it."""
    q, curve, radius = _drawn(robot, rng)
    bars = []
    for place in _places(curve, radius, int(rng.integers(*BARS)), rng):
        half, thickness = 0.5 * radius * rng.uniform(*BAR_LENGTH) * _way(rng), radius * rng.uniform(*BAR)
        capsule = sn.Capsule(place - half, place + half, 1.1 * thickness)
        if float(measure(capsule, curve.points).min()) > LEEWAY * radius:
            pose = sn.pose(direction=half)
            ends = np.array([pose, pose])
            ends[:, :3, 3] = place - half, place + half
            bars.append(tube(ends, thickness, sides=8, caps=2))
    bodies = solid(joined(bars), "assembly").bodies() if bars else ()
    return sketch_of(robot, bodies, q, rng)


def _drawn(robot: sn.Robot, rng: Generator) -> tuple[Floats, Curve, float]:
    radius = max(robot.radii)
    q = draw_shape(robot, APART * radius, rng)
    return q, curve_of(robot, q, 12), radius


def _way(rng: Generator) -> Floats:
    way = rng.normal(size=3)
    return np.asarray(way / np.linalg.norm(way))


def _places(curve: Curve, radius: float, count: int, rng: Generator) -> Floats:
    """Places (m, 3) evenly spread within some distance of the shape."""
    low, high = curve.points.min(axis=0) - AROUND * radius, curve.points.max(axis=0) + AROUND * radius
    near, found = cKDTree(curve.points), np.zeros((0, 3))
    while len(found) < count:
        drawn = rng.uniform(low, high, (4 * count, 3))
        found = np.concatenate([found, drawn[near.query(drawn)[0] < AROUND * radius]])
    return found[:count]


def _crowd(
    robot: sn.Robot,
    rng: Generator,
    part: Callable[[Floats, float], list[Obstacle]],
    each: int,
    threaded: Callable[[Curve], list[Obstacle]] | None = None,
) -> Sketch:
    """Draw parts, of up to `each` obstacles, and keep those that leave the shape alone, until there are enough."""
    q, curve, radius = _drawn(robot, rng)
    wanted, kept = int(rng.integers(*PARTS)), list[Obstacle]()
    tries = max(8, MADE * wanted // each)
    for i, place in enumerate(_places(curve, radius, tries, rng)):
        made = threaded(curve) if threaded is not None and 3 * i < tries else part(place, radius)
        if all(float(measure(own, curve.points).min()) > LEEWAY * radius for own in made):
            kept += made
        if len(kept) >= wanted:
            break
    return sketch_of(robot, kept, q, rng)
