"""Lines of points: how far they are from the obstacles."""

import numpy as np
import pytest

from sinuous.kernels.fitting.lines import LINE_SIDES, SIDE_STEPS, widths_across
from sinuous.scene.obstacles import Box
from sinuous.scene.scene import Scene
from tests.helpers import Floats


def beside(scene: Scene, line: Floats, radius: float, enough: float) -> Floats:
    room = np.empty(len(line))
    widths_across(scene.snapshot().group.copy(), line, radius, enough, room)
    return room


def some_lines(seed: int) -> tuple[Scene, Floats]:
    rng = np.random.default_rng(seed)
    scene = Scene([Box(rng.uniform(-1.0, 1.0, 3), rng.uniform(0.2, 0.5, 3)) for _ in range(9)])
    return scene, np.linspace(rng.uniform(-2.0, 0.0, 3), rng.uniform(0.0, 2.0, 3), 60)


@pytest.mark.parametrize("seed", range(4))
def test_the_width_across_a_line_is_that_of_a_place_at_most_so_far_aside(seed: int) -> None:
    scene, line = some_lines(seed)
    radius, enough = 0.1, 0.4
    found, own = beside(scene, line, radius, enough), scene.distance(line)
    ahead = (line[-1] - line[0]) / np.linalg.norm(line[-1] - line[0])
    x = np.cross(ahead, (0.3, 0.5, 0.8))
    x /= np.linalg.norm(x)
    angles = np.linspace(0.0, 2.0 * np.pi, 200 * LINE_SIDES)[:, None]
    ring = np.cos(angles) * x + np.sin(angles) * np.cross(ahead, x)
    around = line[:, None, None] + radius * np.arange(1, SIDE_STEPS + 1)[:, None, None] * ring
    most = np.maximum(own, scene.distance(around).max(axis=(1, 2)))
    free = (own > 0.0) & (own < enough)
    assert free.any()
    assert (found[free] >= own[free] - 1e-12).all()
    assert (found[free] <= most[free] + 0.01 * radius).all()
    np.testing.assert_allclose(found[own <= 0.0], own[own <= 0.0])
    assert (found[own >= enough] >= enough).all()


def test_a_wall_between_two_points_is_not_stepped_over() -> None:
    door = Scene([Box((side * 1.15, 0.0, 0.0), (2.0, 4.0, 0.1)) for side in (-1.0, 1.0)])
    coarse = np.array([(0.0, 0.0, z) for z in (-3.6, -2.1, -0.6, 0.9, 2.4)])
    assert door.distance(coarse).min() > 0.4
    room = beside(door, coarse, 0.1, 0.4)
    assert room[2] == pytest.approx(0.15, abs=0.01)
    assert (room[[0, 1, 4]] >= 0.4).all()
    assert (beside(door, coarse, 0.0, 0.4) >= 0.4).all()
