"""Problems are those of their seed, can be solved where they say so, and are as described."""

import math

import numpy as np
import pytest

import sinuous as sn
from benchmarks import problems
from benchmarks.judges.collisions import Body
from benchmarks.judges.judge import judge, within_limits
from benchmarks.judges.kinematics import tip_poses
from benchmarks.problems import sets


def test_configurations_fill_their_limits_and_keep_them() -> None:
    robot = sn.Robot([sn.Segment((1, 2), 2.0), sn.Segment((0, 1), 3.0, max_curvature=2.0), sn.Segment(1, 0.0)])
    q = problems.random_configurations(robot, 2000, np.random.default_rng(0))
    assert within_limits(robot, q).all()
    bends = np.hypot(q[..., 0], q[..., 1])
    assert bends[:, 0].max() > 1.95
    assert bends[:, 2].max() == 0.0
    assert q[:, 0, 2].min() < 1.05
    assert q[:, 0, 2].max() > 1.95


def test_reachable_targets_are_reached_by_what_they_were_drawn_from() -> None:
    robot = problems.arm(5, 2.4)
    q = problems.random_configurations(robot, 50, np.random.default_rng(3))
    drawn = problems.reachable(robot, 50, np.random.default_rng(3))
    assert judge(robot, drawn.targets, q, problems.relative_tolerance(robot, 1e-12)).right.all()


def test_full_poses_are_drawn_as_published() -> None:
    asked = problems.full_poses(7, 1000)
    rng = np.random.default_rng(7)
    bends, angles = math.pi * rng.random((1000, 3)), 2 * math.pi * rng.random((1000, 3))
    q = np.stack([bends * np.cos(angles), bends * np.sin(angles), np.ones((1000, 3))], axis=-1)
    np.testing.assert_allclose(np.array(asked.targets[42].position), tip_poses(asked.robot, q)[42, :3, 3])
    assert judge(asked.robot, asked.targets, q, asked.tolerance).right.all()


def test_paper_poses_are_those_of_the_paper() -> None:
    asked = problems.paper_poses()
    assert len(asked.robot) == 5
    assert [segment.length for segment in asked.robot.segments] == [(45.0, 70.0)] * 5
    np.testing.assert_allclose(asked.robot.base[:3, 2], [0, 0, -1])
    np.testing.assert_allclose(np.array(asked.targets[2].position), [150, -90, -220])
    assert (asked.tolerance.position, asked.tolerance.angle) == (1e-6, 1e-6)


def test_spheres_leave_the_base_free_and_targets_possible() -> None:
    robot = problems.arm(5, 2.4, radius=4.0)
    asked = problems.among_spheres(robot, 40, 30, np.random.default_rng(1))
    assert len(asked.scene) == 40
    assert float(asked.scene.distance(robot.base[:3, 3])) > 0.15 * robot.mean_length
    q = problems.free_configurations(robot, asked.scene, 30, np.random.default_rng(5))
    assert not any(Body(robot, asked.scene).overlaps(q))


def test_no_room_is_said_and_not_searched_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sets, "PATIENCE", 3)
    robot = problems.arm(3, 2.0, radius=4.0)
    filled = sn.Scene([sn.Sphere((0, 0, 0), 1000)])
    with pytest.raises(RuntimeError, match="no room"):
        problems.free_configurations(robot, filled, 1, np.random.default_rng(0))


def test_clutter_is_made_again_by_its_seed_and_is_of_all_kinds() -> None:
    first, again = problems.clutter(3, 10), problems.clutter(3, 10)
    np.testing.assert_array_equal(first.scene.table, again.scene.table)
    np.testing.assert_array_equal(first.targets[9].table, again.targets[9].table)
    made = [problems.clutter(seed, 2) for seed in range(30)]
    kinds = {type(obstacle).__name__ for asked in made for obstacle in asked.scene.obstacles}
    assert kinds == {"Sphere", "Box", "Capsule", "Cylinder", "HalfSpace"}
    assert {len(asked.robot) for asked in made} == {3, 4, 5, 6}
    assert any(getattr(obstacle, "inside", False) for asked in made for obstacle in asked.scene.obstacles)
