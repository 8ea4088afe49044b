"""What is in sight of what, against points all along the line."""

import numpy as np
import pytest

from sinuous.kernels.roadmap.sight import LINE_CLEARANCE, cutting, in_sight
from sinuous.scene.obstacles import Box
from sinuous.scene.scene import Scene
from tests.helpers import Floats, kernel_scene, vec
from tests.kernels.freespace.places import RADIUS, grid

NO_TRIANGLES = np.empty((0, 12))


def boxes(seed: int) -> list[Box]:
    rng = np.random.default_rng(seed)
    return [Box(rng.uniform(-1, 1, 3), rng.uniform(0.1, 0.8, 3), rng.normal(size=4)) for _ in range(6)]


def lines(seed: int, count: int) -> Floats:
    return np.random.default_rng(100 + seed).uniform(-1.5, 1.5, (count, 2, 3))


def along(line: Floats) -> Floats:
    return np.linspace(line[0], line[1], 2000)


@pytest.mark.parametrize("seed", range(3))
def test_a_line_that_keeps_away_is_in_sight_and_one_that_does_not_is_not(seed: int) -> None:
    scene = Scene(boxes(seed))
    packed, seen = kernel_scene(scene), 0
    for line in lines(seed, 60):
        least = scene.distance(along(line)).min() / RADIUS
        visible, looks = in_sight(packed, grid(), vec(line[0]), vec(line[1]))
        assert looks > 0
        assert visible or least < LINE_CLEARANCE + 1e-6
        assert not visible or least > LINE_CLEARANCE - 0.08  # no step is shorter than 0.15 radii
        seen += visible
    assert 5 < seen < 55


@pytest.mark.parametrize("seed", range(3))
def test_a_box_cuts_a_line_where_points_of_it_are_within(seed: int) -> None:
    scene = Scene(boxes(seed))
    packed = kernel_scene(scene)
    recent = np.full(3, -1)
    for line in lines(seed, 60):
        found, asked = cutting(packed, NO_TRIANGLES, vec(line[0]), vec(line[1]), recent)
        assert 1 <= asked <= 3 + 6
        assert found in (-1, recent[0])
        inside = scene.snapshot().distance_to(found, along(line))[0] if found >= 0 else scene.distance(along(line))
        assert inside.min() < 1e-3 if found >= 0 else inside.min() >= 0.0
