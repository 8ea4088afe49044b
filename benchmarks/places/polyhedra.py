"""The scenes of balls that published codes were measured in (protocols P3 and P4), with targets from free shapes."""

import itertools
import math
from functools import lru_cache

import numpy as np

import sinuous as sn
from benchmarks.judges.clearances import least_clearance
from benchmarks.judges.kinematics import tip_poses
from benchmarks.places.place import Place
from benchmarks.problems import published_configurations

RADIUS = 0.01
"""Of the body; segments are 1 long, or 0.15 to 0.55."""

TOLERANCE = sn.Tolerance(0.7e-6, 0.7e-6)
"""Published codes were asked for an error of 1e-2 in se(3); ours is asked for 1e-6."""

SHORT = (0.15, 0.55)


def _icosahedron() -> list[tuple[float, ...]]:
    a, b = 0.5257, 0.8507
    signs = list(itertools.product((-1.0, 1.0), repeat=2))
    flat = [(0.0, s * a, t * b) for s, t in signs]
    return [vertex[-k:] + vertex[:-k] for vertex in flat for k in range(3)]


SCENES = (
    ([(0.8 * s * (i == 0), 0.8 * s * (i == 1), 0.8 * s * (i == 2)) for i in range(3) for s in (-1, 1)], 0.4),
    (list(itertools.product((-0.8, 0.8), repeat=3)), 0.4),
    (_icosahedron(), 0.4),
    (list(itertools.product((-0.8, 0.0, 0.8), (-0.4, 0.4, 1.2), (-0.8, 0.2, 1.2))), 0.2),
)
"""Centers and radius of the balls: corners of an octahedron, a cube and an icosahedron, and a lattice."""


@lru_cache
def _scene(number: int) -> sn.Scene:
    centers, radius = SCENES[number]
    return sn.Scene([sn.Sphere(center, radius) for center in centers])


@lru_cache
def _robot(count: int, short: bool) -> sn.Robot:
    return sn.Robot.uniform(count, SHORT if short else 1.0, math.pi, radius=RADIUS)


def fixed(seed: int) -> Place:
    """P3: three inextensible segments, position and rotation; scenes in turn."""
    return _draw("p3", seed, _robot(3, False), _scene(seed % 4), whole=True)


def extensible(seed: int, whole: bool) -> Place:
    """P4: three to six extensible segments, position and direction or (`whole`) rotation; scenes and robots in turn."""
    family = "p4 pose" if whole else "p4 direction"
    return _draw(family, seed, _robot(3 + seed // 4 % 4, True), _scene(seed % 4), whole)


def _draw(family: str, seed: int, robot: sn.Robot, scene: sn.Scene, whole: bool) -> Place:
    """Draw shapes until one is free."""
    rng = np.random.default_rng([seed, len(robot), int(whole)])
    while True:
        q = published_configurations(robot, 1, rng)[0]
        if least_clearance(robot, scene, q[None], 0.0)[0] > 0.0:
            break
    tip = tip_poses(robot, q[None])[0]
    asked = {"rotation": tip[:3, :3]} if whole else {"direction": tip[:3, 2]}
    return Place(family, seed, robot, scene, (sn.Target(tip[:3, 3], **asked),), TOLERANCE, q)
