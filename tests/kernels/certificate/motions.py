"""Random robots, places and motions, and what dense sampling of a motion finds."""

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np

import sinuous as sn
from tests.helpers import Floats
from tests.self_gaps import gaps_of, sample_body

TIMES, PLACES = 31, 24


class Case(NamedTuple):
    """A robot, obstacles, and the two configurations (n, 3) of a motion."""

    robot: sn.Robot
    scene: sn.Scene
    q0: Floats
    q1: Floats


def shape(robot: sn.Robot, rng: np.random.Generator) -> Floats:
    """A configuration (n, 3) within the limits."""
    angles = rng.uniform(0.0, 2.0 * math.pi, len(robot))
    lengths = np.array([rng.uniform(*segment.length) for segment in robot.segments])
    caps = np.array([segment.max_bend for segment in robot.segments])
    bends = np.minimum(caps, np.array(robot.curvatures) * lengths) * np.sqrt(rng.random(len(robot)))
    return np.stack([bends * np.cos(angles), bends * np.sin(angles), lengths], axis=-1)


def obstacle(rng: np.random.Generator) -> sn.Sphere | sn.Box | sn.Cylinder:
    """A primitive; some of those are rooms that the body must stay inside of."""
    center, kind = rng.uniform(-3.0, 3.0, 3), rng.integers(5)
    if kind == 0:
        return sn.Box((0, 0, 0), rng.uniform(5.0, 16.0, 3), inside=True)
    if kind == 1:
        return sn.Box(center, rng.uniform(0.1, 1.0, 3))
    if kind == 2:
        return sn.Cylinder(center, center + rng.uniform(-1.0, 1.0, 3), float(rng.uniform(0.05, 0.4)))
    return sn.Sphere(center, float(rng.uniform(0.05, 0.6)))


@cache
def random_case(seed: int) -> Case:
    """A motion of a robot of one to seven segments: a hundredth, a fifth or all of its range."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 8))
    radii = np.full(n, 0.05) if rng.random() < 0.5 else rng.uniform(0.02, 0.12, n)
    lowest = 0.0 if rng.random() < 0.2 else 0.6
    segments = [sn.Segment((lowest, 1.2), 2.8, radius=float(radius)) for radius in radii]
    robot = sn.Robot(segments, mount=float(rng.choice([0.0, 0.3, 1.0])))
    q0 = shape(robot, rng)
    q1 = q0 + float(rng.choice([0.01, 0.2, 1.0])) * (shape(robot, rng) - q0)
    return Case(robot, sn.Scene([obstacle(rng) for _ in range(int(rng.integers(0, 10)))]), q0, q1)


@cache
def sampled_case(seed: int) -> tuple[float, float]:
    """What is `sampled` of a random case."""
    return sampled(random_case(seed))


def sampled(case: Case) -> tuple[float, float]:
    """Least clearance and least self-clearance over many times and places."""
    t = np.linspace(0.0, 1.0, TIMES)[:, None, None]
    q = (1.0 - t) * case.q0 + t * case.q1
    places, thick, free = sampled_bodies(case.robot, q, PLACES)
    away = case.scene.distance(places) - thick if len(case.scene) else np.full(free.shape, math.inf)
    gap = min(float(gaps_of(sample_body(one, np.array(case.robot.radii), PLACES)).min()) for one in q)
    return float(away[free].min(initial=math.inf)), gap


def sampled_bodies(robot: sn.Robot, q: Floats, count: int) -> tuple[Floats, Floats, Any]:
    """Places (m, k, 3) of configurations, `count` of a segment; radii (k,); and which of them are beyond the mount."""
    thick = np.append(np.repeat(np.array(robot.radii), count), robot.radii[-1])
    along = np.pad(np.cumsum(np.repeat(q[:, :, 2] / count, count, axis=1), axis=1), ((0, 0), (1, 0)))
    return robot.backbone(q, count), thick, along >= robot.mount
