"""Tubes found by the rims of their mouths: their axes lie in the middle, from one mouth to the other."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from benchmarks.places.parts.surfaces import hollow, open_tube, solid
from sinuous import Box, Scene, Sphere
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.tubes.mouths import find_tubes
from sinuous.scene.obstacles import Obstacle
from sinuous.solving.routing.edges import rims_of
from tests.helpers import Floats
from tests.kernels.tubes.test_axis import RADIUS, curve, walls


def found(obstacles: list[Obstacle], most: int = 8, points: int = 1000) -> list[tuple[Floats, bool]]:
    """The axes of all tubes, and whether they are open at both ends."""
    scene = Scene(obstacles).snapshot()
    axes, ends, clock = np.empty((points, 3)), np.zeros((most, 3), np.int64), np.zeros(CLOCK_SIZE, np.int64)
    count = find_tubes(scene.group.copy(), rims_of(scene), RADIUS, 60.0, clock, axes, ends)
    return [(axes[first:last], bool(through)) for first, last, through in ends[:count]]


def gap(place: Floats, other: Floats) -> float:
    return float(np.linalg.norm(place - other))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("width", [1.3, 1.8])
def test_a_bent_pipe_is_found_from_mouth_to_mouth(width: float, seed: int) -> None:
    poses = curve(seed, 12)
    ((axis, through),) = found([solid(open_tube(poses, width * RADIUS, (width + 0.8) * RADIUS), "pipe")])
    assert through
    gaps, _ = cKDTree(curve(seed, 120)[:, :3, 3]).query(axis[2:-2])
    assert np.max(gaps) <= 0.5 * RADIUS
    ends = poses[[0, -1], :3, 3]
    straight, turned = (max(gap(axis[0], a), gap(axis[-1], b)) for a, b in (ends, ends[::-1]))
    assert min(straight, turned) <= 1.6 * RADIUS


def test_a_channel_of_boxes_is_found_once() -> None:
    ((axis, through),) = found(list(walls(0.2, 0.5)))
    assert through
    assert np.abs(axis[:, :2]).max() <= 0.2 * RADIUS
    assert np.sort(axis[[0, -1], 2]) == pytest.approx([-0.5, 2.5], abs=1.6 * RADIUS)


def test_a_channel_that_is_closed_is_not_open() -> None:
    lid = Box((0.0, 0.0, 2.6), (1.0, 1.0, 0.2))
    assert not any(through for _, through in found([*walls(0.2, 0.5), lid]))


def test_there_is_none_in_a_closed_pipe_a_wide_hall_a_thin_door_and_beside_one_box() -> None:
    assert not found([solid(hollow(curve(0, 12), 1.3 * RADIUS, 2.1 * RADIUS), "pipe")])
    assert not found(list(walls(2.0, 5.0)))
    assert not found([Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), Sphere((3.0, 0.0, 0.0), 1.0)])
    half, thick = 1.5 * RADIUS, 0.05
    door = [Box((side * (1.0 + half), 0.0, 0.0), (2.0, 4.0, thick)) for side in (-1.0, 1.0)]
    door += [Box((0.0, side * (1.0 + half), 0.0), (2.0 * half, 2.0, thick)) for side in (-1.0, 1.0)]
    assert not found(list(door))


def test_tables_that_are_full_are_not_written_beyond() -> None:
    pipe = solid(open_tube(curve(0, 12), 1.5 * RADIUS, 2.3 * RADIUS), "pipe")
    for points in range(1, 12):
        for axis, _ in found([pipe], points=points):
            assert len(axis) <= points
    assert len(found([*walls(0.2, 0.5), pipe], most=1)) == 1
