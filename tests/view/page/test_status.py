"""What is said of a shape: the nearest places lie on the surfaces, and errors are those that solutions tell."""

import numpy as np

import sinuous as sn
from sinuous.view.page.status import find_nearest

ROBOT = sn.Robot.uniform(3, length=(0.8, 1.2), max_bend=2, radius=0.05)
SCENE = sn.Scene([sn.Sphere((0.5, 0, 1.5), radius=0.2, name="ball"), sn.Box((-1, 0, 1), (0.5, 0.5, 0.5), name="crate")])


def test_the_line_to_the_nearest_place_ends_on_both_surfaces() -> None:
    for seed in range(20):
        q = np.random.default_rng(seed).uniform((-1, -1, 0.8), (1, 1, 1.2), (3, 3))
        near = find_nearest(ROBOT, SCENE.snapshot(), q)
        assert near is not None
        assert abs(float(SCENE.distance(near.surface))) < 1e-6
        if near.distance > 0.0:  # deep within a box, its other side may be nearer to the surface of the body
            assert abs(float(SCENE.distance(near.body)) - near.distance) < 1e-6
        points = ROBOT.backbone(q, 16)
        assert np.isclose(near.distance, float(SCENE.distance(points).min()) - 0.05, atol=1e-9)


def test_there_is_no_nearest_place_without_obstacles_or_within_the_mount() -> None:
    q = np.array([[0.0, 0.0, 1.0]] * 3)
    assert find_nearest(ROBOT, sn.Scene().snapshot(), q) is None
    free = find_nearest(ROBOT, SCENE.snapshot(), q)
    mounted = find_nearest(ROBOT.changed(mount=2.5), SCENE.snapshot(), q)
    assert free is not None
    assert mounted is not None
    assert mounted.distance > free.distance
