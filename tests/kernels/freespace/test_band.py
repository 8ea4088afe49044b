"""Routes as elastic bands: evenly spaced, tight, and away from obstacles."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.kernels.freespace import band
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene
from tests.cases import with_each
from tests.helpers import Floats, kernel_scene
from tests.kernels.freespace.places import RADIUS, grid
from tests.kernels.workspace import make_clock


def length_of(points: Floats) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


@with_each("seed", range(5))
def test_points_are_put_evenly_on_the_same_line(seed: int) -> None:
    rng = np.random.default_rng(seed)
    line = np.cumsum(rng.normal(size=(9, 3)), axis=0)
    line[4] = line[3]  # points may coincide
    out = np.empty((200, 3))
    spacing = band.respace(line, 9, out, 200)
    assert spacing == pytest.approx(length_of(line) / 199)
    assert band.span(line, 9) == pytest.approx(length_of(line))
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    at = spacing * np.arange(200)
    for axis in range(3):
        kept = np.concatenate([[True], np.diff(along) > 0.0])
        assert np.allclose(out[:, axis], np.interp(at, along[kept], line[kept, axis]))


def tight(points: Any, scene: Scene) -> Floats:
    route = np.empty((60, 3))
    band.respace(np.array(points, np.float64), len(points), route, 60)
    band.tighten(kernel_scene(scene), grid(), route, np.empty((120, 3)), make_clock(), 60)
    return route


def test_a_detour_in_the_open_is_drawn_tight() -> None:
    loose = [(0, 0, 0), (0, 0, 0.05), (0.3, 0.4, 1.0), (0, 0, 2.0)]
    route = tight(loose, Scene())
    assert length_of(route) < 0.99 * length_of(np.array(loose))
    assert np.array_equal(route[0], loose[0])
    assert np.array_equal(route[-1], loose[-1])


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


def test_a_longer_route_has_more_points_within_bounds() -> None:
    wanted = [band.points_wanted(length, 0.1, 256) for length in (0.0, 0.3, 1.0, 5.05, 100.0)]
    assert wanted == [band.FEWEST, band.FEWEST, 11, 52, 256]
