"""Routes as elastic bands: evenly spaced, tight, and away from obstacles."""

import math
from typing import Any

import numpy as np

from sinuous.kernels.freespace import band
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_scene
from tests.kernels.freespace.places import RADIUS, grid
from tests.kernels.workspace import make_clock


def tight(points: Any, scene: Scene) -> Floats:
    route = np.empty((60, 3))
    band.respace(np.array(points, np.float64), len(points), route, 60)
    band.tighten(kernel_scene(scene), grid(), route, np.empty((120, 3)), make_clock(), 60)
    return route


def test_a_band_keeps_clear_of_what_it_passes() -> None:
    ball = Sphere((0.1, 0, 1.0), 0.5)
    route = tight([(0, 0, 0), (0, 0, 0.1), (-0.45, 0, 1.0), (0, 0, 2.0)], Scene([ball]))
    middle = route[10:50]
    assert Scene([ball]).distance(middle).min() > RADIUS


def test_a_band_between_walls_runs_in_the_middle() -> None:
    walls = Scene([Box((0.3, 0, 1.0), (0.02, 4, 4)), Box((-0.3, 0, 1.0), (0.02, 4, 4))])
    route = tight([(0, 0, 0), (0, 0, 0.1), (0.15, 0, 0.8), (-0.15, 0, 1.4), (0, 0, 2.0)], walls)
    assert np.abs(route[:, 0]).max() < 0.04


def test_the_ends_keep_their_tangents() -> None:
    points = [(0, 0, 0), (0, 0, 0.2), (1, 0, 0.6), (1, 1, 1), (1, 1.2, 1)]
    route = np.empty((60, 3))
    spacing = band.respace(np.array(points, np.float64), 5, route, 60)
    band.tighten(kernel_scene(Scene()), grid(back=(0.0, -1.0, 0.0)), route, np.empty((120, 3)), make_clock(), 60)
    assert np.allclose(route[1], (0, 0, spacing), atol=0.2 * spacing)
    end = route[-1] - route[-2]
    assert math.degrees(math.acos(end[1] / np.linalg.norm(end))) < 25.0
