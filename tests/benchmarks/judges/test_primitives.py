"""Distances of the judge to many exact shapes are those of the independent measures to each of them."""

from functools import cache

import numpy as np

from benchmarks.judges.primitives import KINDS, distances_to
from benchmarks.wild.worlds import clutter
from sinuous.measures.obstacles import measure
from sinuous.scene.obstacles import Box, Capsule, Cylinder, Primitive, Sphere
from tests.helpers import with_each

ODD = [
    Sphere((0, 0, 0), 1, inside=True),
    Cylinder((0, 0, 0), (0, 1, 2), 0.5, inside=True),
    Box((1, 2, 3), (1, 2, 3), inside=True),
    Capsule((1, 1, 1), (1, 1, 1), 0.3),
]


@cache
def cluttered() -> list[Primitive]:
    """Obstacles of many problems; not made when tests are collected, since that compiles."""
    return [o for seed in range(20) for o in clutter(seed, 1).scene.obstacles if isinstance(o, Primitive)]


@with_each("kind", KINDS)
def test_the_least_of_one_kind(kind: type[Primitive]) -> None:
    for obstacles in ([o for o in cluttered() if type(o) is kind], [o for o in ODD if type(o) is kind]):
        points = np.random.default_rng(0).normal(size=(500, 3)) * 2.0
        expected = [measure(obstacle, points) for obstacle in obstacles]
        found = [distance(points) for distance in distances_to(obstacles)]
        assert len(found) == bool(obstacles)
        if obstacles:
            np.testing.assert_allclose(found[0], np.min(expected, axis=0), rtol=0, atol=1e-13)
