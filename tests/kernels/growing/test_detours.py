"""Routes that are led aside: as long as wanted, out of all obstacles, and the same in every unit."""

import numpy as np

from sinuous import Box, Cylinder, Scene, Sphere
from sinuous.base.checks import Floats
from sinuous.kernels.growing.detours import LONG_ENOUGH, MOST_DETOURS, NUMBERS, add_detours, detours_size

POINTS, RADIUS = 64, 0.1
LINE = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 3.0), POINTS)
SCENE = Scene([Box((0.0, 0.0, 1.5), size=(4.0, 0.4, 0.4)), Sphere((0.8, 0.9, 1.0), 0.4)])
AROUND = np.concatenate([np.linspace((0.0, 0.0, 0.0), (0.0, 0.6, 1.5), 32), np.linspace((0.0, 0.6, 1.5), LINE[-1], 32)])


def led(line: Floats, wanted: float, seed: int, scene: Scene = SCENE, unit: float = 1.0) -> tuple[float, Floats]:
    points, numbers = unit * line, np.random.default_rng(seed).random((MOST_DETOURS, NUMBERS))
    group, work = scene.snapshot()._kernel_group, np.full(detours_size(len(line)), np.nan)
    return add_detours(group, unit * wanted, unit * RADIUS, numbers, 60.0, work, points), points


def test_a_route_becomes_as_long_as_wanted_and_stays_out_of_obstacles() -> None:
    lengths = []
    for seed in range(20):
        length, points = led(AROUND, 6.0, seed)
        np.testing.assert_array_equal(points[[0, -1]], AROUND[[0, -1]])
        np.testing.assert_allclose(np.linalg.norm(np.diff(points, axis=0), axis=1).sum(), length, rtol=0.05)
        assert SCENE.distance(points).min() > 0.0
        assert length <= 6.0
        lengths.append(length)
    assert np.mean(np.array(lengths) >= LONG_ENOUGH * 6.0) > 0.5
    assert len(set(lengths)) == 20


def test_a_route_that_is_long_enough_and_one_without_room_stay_as_they_are() -> None:
    tube = Scene([Cylinder((0, 0, -1), (0, 0, 4), 1.4 * RADIUS, inside=True)])
    for line, wanted, scene in ((AROUND, 3.0, SCENE), (LINE, 6.0, tube)):
        length, points = led(line, wanted, 0, scene)
        np.testing.assert_allclose(length, np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        np.testing.assert_allclose(points, line, atol=0.05)
