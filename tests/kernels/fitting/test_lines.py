"""Lines of points: how far they are from the obstacles."""

import numpy as np
import pytest

from sinuous.kernels.fitting.lines import measure_line, respace_line, room_along
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene


@pytest.mark.parametrize("seed", range(3))
def test_distances_are_those_of_the_scene_up_to_a_reach(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scene = Scene([Box((0.0, 0.5, 1.0), (0.4, 0.3, 0.6)), Sphere((1.0, 0.0, 0.5), 0.3)])
    points, reach = rng.uniform(-2.0, 2.0, (200, 3)), 0.8
    found, true = np.empty(200), scene.distance(points)
    room_along(scene.snapshot().group.copy(), points, reach, found)
    near = true < reach
    assert near.any()
    assert not near.all()
    np.testing.assert_allclose(found[near], true[near])
    assert (found[~near] >= reach).all()


@pytest.mark.parametrize("count", [1, 2, 30])
def test_the_length_of_a_line_is_that_of_its_steps(count: int) -> None:
    line, along = np.random.default_rng(count).normal(size=(count, 3)), np.empty(count)
    measure_line(line, along)
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    np.testing.assert_allclose(along, [steps[:i].sum() for i in range(count)], rtol=1e-14)


def test_a_line_of_one_place_stays_there() -> None:
    out = np.empty((5, 3))
    respace_line(np.ones((3, 3)), out)
    assert (out == 1.0).all()
