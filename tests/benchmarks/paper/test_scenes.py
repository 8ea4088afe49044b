"""The problems of the experiments are as described."""

import numpy as np
import pytest

from benchmarks.paper import scenes
from sinuous.scene.obstacles import Sphere


def test_paths_and_the_base_are_free_and_lengths_within_a_tenth() -> None:
    problems = scenes.path_through(8, 70, np.random.default_rng(1))
    points = np.array([target.position for target in problems.targets])
    assert points.shape == (180, 3)
    np.testing.assert_allclose(points, scenes.far_path())
    assert float(problems.scene.distance(points).min()) >= scenes.PATH_GAP * scenes.TOTAL
    stub = np.linspace(0.0, scenes.BASE_LENGTH * scenes.TOTAL, 7)[:, None] * [0.0, 0.0, 1.0]
    assert float(problems.scene.distance(stub).min()) > 0.9 * scenes.BASE_GAP * scenes.TOTAL
    assert problems.robot.mean_length == pytest.approx(scenes.TOTAL)
    for segment in problems.robot.segments:
        assert segment.length == pytest.approx((54.0, 66.0))
    assert all(target.direction is None and target.rotation is None for target in problems.targets)


def test_spheres_have_random_places_and_radii_of_their_seed() -> None:
    first, again, other = (scenes.path_through(8, 40, np.random.default_rng(seed)) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first.scene.table, again.scene.table)
    assert not np.array_equal(first.scene.table, other.scene.table)
    radii = [o.radius for o in first.scene.obstacles if isinstance(o, Sphere)]
    assert len(radii) == 40
    assert 0.03 * scenes.TOTAL <= min(radii) < 0.04 * scenes.TOTAL
    assert 0.07 * scenes.TOTAL < max(radii) <= 0.08 * scenes.TOTAL


def test_fewer_waypoints_lie_on_the_same_path() -> None:
    problems = scenes.path_through(5, 0, np.random.default_rng(0), 12)
    np.testing.assert_allclose(np.array([t.position for t in problems.targets]), scenes.far_path()[::15])


def test_poses_of_the_paper_are_repeated() -> None:
    problems = scenes.paper_pose("C", 4)
    assert len(problems.targets) == 4
    np.testing.assert_allclose(np.array(problems.targets[3].position), [150, -90, -220])
    assert (problems.tolerance.position, problems.tolerance.angle) == (1.0, 0.0175)
