"""Odd robots in odd scenes, and what may be asked of them: much is at the edge of what can be said."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.wild.obstacles import block_surface, pose_rotation
from benchmarks.wild.robots import robot_with_shapes
from benchmarks.wild.worlds import UNITS, asked, demanding
from sinuous.base.checks import Floats

OBSTACLES = (0, 0, 1, 2, 5, 20)

LOADS = (-6.0, 3.0)
"""Powers of ten of weight times the square of the length, of the stiffness EI."""


def robot(rng: Generator) -> sn.Robot:
    """A robot of the wild worlds, or one of which much is at the edge of what can be said; some have demands."""
    own = robot_with_shapes(1, rng, UNITS)[0] if rng.random() < 0.3 else _edged(rng)
    return demanding(own, rng) if own.self_collision == "avoid" and rng.random() < 0.3 else own


def _edged(rng: Generator) -> sn.Robot:
    unit = 10.0 ** rng.uniform(*UNITS)
    count = int(rng.choice([1, 1, 2, 3, 5, 8, 15]))
    radius = float(rng.choice([0.0, 1e-6, 0.01, 0.1, 0.6])) * unit
    drive = str(rng.choice(["none", "none", "tendons", "chambers"]))
    segments = [_segment(unit, radius, drive, rng) for _ in range(count)]
    gravity = 9.81 * rng.normal(size=3) if rng.random() < 0.25 else None
    carried = 10.0 ** rng.uniform(-3.0, 1.0)
    if gravity is not None:
        bend = float(np.linalg.norm(gravity)) * carried * (count * unit) ** 2 / 10.0 ** rng.uniform(*LOADS)
        segments = [_loaded(each, bend, carried / unit, rng) for each in segments]
    longest = sum(segment.length[1] for segment in segments)
    return sn.Robot(
        segments,
        base=None if rng.random() < 0.5 else sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)),
        tool=_tool(unit, rng),
        mount=float(rng.choice([0.0, 0.0, 0.3, 1.0, 1.5])) * longest,
        self_collision="avoid" if rng.random() < 0.5 else "allow",
        gravity=gravity,
        payload=sn.Payload(carried) if gravity is not None and rng.random() < 0.5 else None,
    )


def _segment(unit: float, radius: float, drive: str, rng: Generator) -> sn.Segment:
    own = unit * float(rng.choice([1e-3, 0.3, 1.0, 1.0, 3.0]))
    low = own * float(rng.choice([0.0, 1e-9, 0.5, 1.0, 1.0]))
    bend = float(rng.choice([0.0, 1e-9, 0.3, 2.0, math.pi, 7.0]))
    curvature = None if rng.random() < 0.7 else float(rng.choice([0.0, 0.1, 3.0])) / own
    own_radius = radius * float(rng.choice([0.0, 0.5, 1.0, 1.0, 1.0]))
    arm = 0.1 * unit
    motor: dict[str, Any] = {"gain": float(rng.choice([-1.0, 1e-3, 200.0])), "offset": float(rng.choice([0.0, 7.0]))}
    motor = motor if rng.random() < 0.3 else {}
    tendons = sn.Tendons(3, arm, displacement=(-0.2 * unit, 0.2 * unit), **motor) if drive == "tendons" else None
    chambers = sn.Chambers(3, arm, length=(0.5 * low, 1.5 * own), **motor) if drive == "chambers" else None
    return sn.Segment((low, own), bend, curvature, own_radius, tendons, chambers)


def _loaded(segment: sn.Segment, bend: float, mass: float, rng: Generator) -> sn.Segment:
    """The segment with a stiffness EI, or without any, and a mass per length."""
    if rng.random() < 0.2:
        return segment.changed(mass=mass)
    twist, stretch = (bend if rng.random() < 0.5 else None for _ in range(2))
    return segment.changed(stiffness=sn.Stiffness(bend, twist, stretch), mass=mass, arcs=int(rng.integers(1, 5)))


def _tool(unit: float, rng: Generator) -> Floats | None:
    kind = rng.integers(4)
    if kind < 2:
        return None
    if kind == 2:
        return sn.pose((0.0, 0.0, 0.0), direction=(1e-8, 0.0, 1.0))
    return sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4))


def size(robot: sn.Robot) -> float:
    """Return the longest length of a robot, or what is greater than 0."""
    return max(sum(segment.length[1] for segment in robot.segments), 1e-300)


def scene(robot: sn.Robot, rng: Generator) -> sn.Scene:
    """Obstacles of every kind, anywhere: about the base, around everything, without any thickness."""
    unit = size(robot)
    obstacles = [_obstacle(robot, unit, rng) for _ in range(int(rng.choice(OBSTACLES)))]
    scene = sn.Scene(obstacles)
    try:
        scene.prepare()
    except sn.InputError:  # a mesh that is refused as it is
        return sn.Scene()
    return scene


def _obstacle(robot: sn.Robot, unit: float, rng: Generator) -> Any:
    base = robot.base[:3, 3]
    place = base + unit * float(rng.choice([0.0, 0.3, 1.0])) * rng.normal(size=3)
    size = unit * 10.0 ** rng.uniform(-3.0, 0.5)
    turn, end = pose_rotation(rng.normal(size=4)), place + size * rng.normal(size=3)
    surface = block_surface(place, 0.3 * size * rng.uniform(0.1, 1.0, 3), turn)
    made: list[Callable[[], Any]] = [
        lambda: sn.Sphere(place, size),
        lambda: sn.Box(place, size * rng.choice([1e-6, 0.1, 1.0, 1.0], 3), turn),
        lambda: sn.Capsule(place, end, 0.2 * size),
        lambda: sn.Cylinder(place, end, 0.2 * size, inside=bool(rng.random() < 0.2)),
        lambda: sn.HalfSpace(place - unit * turn[:, 2], turn[:, 2]),
        lambda: sn.Sphere(base, 2.0 * unit, inside=True),
        lambda: sn.Mesh(surface.vertices, surface.faces[: len(surface.faces) - int(rng.integers(2))]),
        lambda: sn.PointCloud(place + size * rng.normal(size=(int(rng.choice([1, 30])), 3)), 0.05 * size),
        lambda: sn.Grid(rng.random((4, 3, 5)) < 0.2, place, 0.2 * size),
        lambda: sn.Field(partial(_ball, place, size), place - size, place + size, 0.5 * size),
        lambda: sn.Moving(sn.Sphere((0.0, 0.0, 0.0), size), [0.0, 1.0], [place, end]),
    ]
    return made[rng.integers(len(made))]()


def _ball(center: Floats, radius: float, places: Floats) -> Floats:
    return np.asarray(np.linalg.norm(places - center, axis=1) - radius)


def shape(robot: sn.Robot, rng: Generator) -> Floats:
    """A configuration within all limits; where actuators forbid what was drawn, a straight one of middle length."""
    low, high = np.array([segment.length for segment in robot.segments]).T
    for share in (1.0, 0.1, 0.0):
        lengths = low + (high - low) * (rng.random(len(robot)) if share else 0.5)
        caps = np.array([s.max_bend for s in robot.segments])
        with np.errstate(invalid="ignore"):
            caps = np.minimum(caps, np.nan_to_num(np.array(robot.curvatures) * lengths, nan=0.0))
        norms = share * (1.0 - 1e-9) * caps * rng.random(len(robot))
        angles = 2.0 * math.pi * rng.random(len(robot))
        q = np.stack([norms * np.cos(angles), norms * np.sin(angles), lengths], axis=-1)
        if not robot.violations(q):
            break
    return np.asarray(q)


def target(robot: sn.Robot, rng: Generator) -> list[sn.Target]:
    """What a shape of the robot meets, or anything else, or several of these."""
    if rng.random() < 0.6:
        return asked(robot, shape(robot, rng)[None], rng)[0]
    unit, base = size(robot), robot.base[:3, 3]
    place = base + unit * float(rng.choice([0.0, 1e-9, 0.5, 1.0, 1e3])) * rng.normal(size=3)
    kind = int(rng.integers(5))
    segment = None if rng.random() < 0.7 else int(rng.integers(1, len(robot) + 1))
    if kind == 0:
        return [sn.Target(place, segment=segment)]
    if kind == 1:
        return [sn.Target(place, direction=-robot.base[:3, 2], segment=segment)]
    if kind == 2:
        return [sn.Target(direction=rng.normal(size=3), segment=segment)]
    if kind == 3:
        return [sn.Target(place, rotation=rng.normal(size=4), segment=segment)]
    return [
        sn.Target(place),
        *[sn.Target(place + unit * rng.normal(size=3), segment=k + 1) for k in range(len(robot) - 1)],
    ]


def tolerance(robot: sn.Robot, rng: Generator) -> sn.Tolerance | None:
    """Draw any tolerance, or none."""
    return (
        None
        if rng.random() < 0.5
        else sn.Tolerance(size(robot) * 10.0 ** rng.uniform(-12, 0), 10.0 ** rng.uniform(-12, 0))
    )
