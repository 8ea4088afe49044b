"""Slow distances to exact obstacles are those of the kernels."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.obstacles import measure, to_boxes

OBSTACLES = [
    sn.Sphere((0.2, 0.3, 1.0), 0.5),
    sn.Sphere((0.2, 0.3, 1.0), 3.0, inside=True),
    sn.Box((0.5, 0, 0.5), (0.4, 0.6, 0.8), (0.9, 0.1, 0.3, 0.2)),
    sn.Box((0.5, 0, 0.5), (4, 6, 8), (0.9, 0.1, 0.3, 0.2), inside=True),
    sn.Capsule((0, 0, 1), (1, 0, 2), 0.3),
    sn.Capsule((0, 0, 1), (0, 0, 1), 0.3),
    sn.Cylinder((0, 0, 1), (1, 0.5, 2), 0.3),
    sn.Cylinder((0, 0, -5), (1, 0.5, 5), 4.0, inside=True),
    sn.HalfSpace((0, 0, -1), (0.1, 0, 1)),
]


@pytest.mark.parametrize("obstacle", OBSTACLES, ids=lambda o: type(o).__name__)
def test_distances_agree_with_the_kernels(obstacle: sn.Sphere) -> None:
    points = np.random.default_rng(0).uniform(-3, 3, (2000, 3))
    np.testing.assert_allclose(measure(obstacle, points), sn.Scene([obstacle]).distance(points), atol=1e-12)


def test_boxes() -> None:
    points = np.array([[2.0, 0, 0], [2, 3, 0], [0.9, 0, 0], [0, 0, 0]])
    np.testing.assert_allclose(to_boxes(points, np.ones(3)), [1, np.sqrt(5), -0.1, -1], atol=1e-15)
