"""A scene of which one obstacle moves is the scene made anew."""

import numpy as np

import sinuous as sn
from sinuous.scene.snapshot import Mover


def test_a_moved_scene_is_the_scene_made_anew() -> None:
    rng = np.random.default_rng(0)
    cloud = sn.PointCloud(rng.normal(size=(50, 3)), 0.05)
    obstacles = [cloud, sn.Sphere((3, 0, 0), 0.5), sn.Box((0, 3, 0), (1, 1, 1)), sn.Sphere((0, 0, 3), 0.5)]
    points = rng.normal(size=(200, 3)) * 3
    snapshot = sn.Scene(obstacles).snapshot()
    mover = Mover(snapshot, 2)
    assert mover.goes_on(snapshot, 2)
    before = snapshot.distance(points)
    for _ in range(5):
        box = sn.Box(rng.normal(size=3) * 3, (1, 2, 1))
        obstacles[2] = box
        moved = mover.moved(box)
        assert moved.obstacles == tuple(obstacles)
        assert mover.goes_on(moved, 2)
        assert not mover.goes_on(moved, 1)
        np.testing.assert_array_equal(moved.distance(points), sn.Scene(obstacles).distance(points))
        np.testing.assert_array_equal(moved.group, sn.Scene(obstacles).group)
    np.testing.assert_array_equal(snapshot.distance(points), before)
