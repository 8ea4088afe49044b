"""Rays about a place: all meet the walls of a room, none meets anything in the open, and frames only turn them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sinuous.kernels.roadmap.enclosed import RAYS, rays_met
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene
from tests.helpers import Floats

PLACE = np.array([0.1, -0.2, 0.3])


def room(*left_out: int) -> list[Box]:
    """Six walls about the origin, 2 away, but for some of them."""
    walls = [(axis, side) for axis in range(3) for side in (-1.0, 1.0)]
    boxes = []
    for i, (axis, side) in enumerate(walls):
        center, size = np.zeros(3), np.full(3, 4.4)
        center[axis], size[axis] = 2.1 * side, 0.2
        if i not in left_out:
            boxes.append(Box(center, size))
    return boxes


def met(scene: Scene, length: float = 5.0, frame: Floats | None = None) -> int:
    turned = np.eye(3) if frame is None else frame
    return rays_met(scene.snapshot()._kernel_group, turned.reshape(1, 9).copy(), PLACE[None].copy(), length)


def test_a_missing_wall_lets_those_through_that_lead_there() -> None:
    for left_out in range(6):
        axis, side = divmod(left_out, 2)
        center = np.zeros(3)
        center[axis] = 2.1 * (2 * side - 1)
        rays = np.array([d for d in np.ndindex(3, 3, 3) if np.count_nonzero(np.array(d) - 1) in (1, 3)], float) - 1.0
        along = np.linspace(0.0, 5.0, 2000)[:, None, None]
        ways = PLACE + along * (rays / np.linalg.norm(rays, axis=1)[:, None])
        scene = Scene(room(left_out))
        expected = int((scene.distance(ways) < 0.1).any(axis=0).sum())
        assert met(scene) == expected < RAYS


@pytest.mark.parametrize("seed", range(5))
def test_frames_turn_with_what_stands_around(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn, directions = Rotation.random(rng=rng), rng.normal(size=(9, 3))
    centers = PLACE + 3.0 * directions / np.linalg.norm(directions, axis=1)[:, None]
    turned = PLACE + turn.apply(centers - PLACE)
    balls, others = (Scene([Sphere(center, 1.2) for center in some]) for some in (centers, turned))
    assert met(balls) == met(others, frame=turn.as_matrix())
    assert 0 < met(balls) < RAYS
