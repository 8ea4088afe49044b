"""Obstacles that move: where they are, and that the scene at a time is the scene of what was moved there.

A scene of which one obstacle moves is the scene made anew.
"""

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

import sinuous as sn
from sinuous.measures.obstacles import measure
from sinuous.scene.obstacles import Obstacle
from tests.helpers import present, refused, with_each
from tests.scene.shapes import EACH_KIND

RNG = np.random.default_rng(0)
TIMES = [0.0, 1.0, 3.0]
POSITIONS, TURNS = RNG.normal(size=(3, 3)), RNG.normal(size=(3, 4))
POINTS = RNG.normal(size=(150, 3)) * 1.5


@with_each("obstacle", [make() for make in EACH_KIND.values()])
@with_each("when", [-1.0, 0.0, 0.3, 2.2, 9.0])
def test_distances_at_a_time_are_those_in_the_moved_frame(obstacle: Obstacle, when: float) -> None:
    moving = sn.Moving(obstacle, TIMES, POSITIONS, TURNS)
    pose = moving.pose(when)
    own = (POINTS - pose[:3, 3]) @ pose[:3, :3]
    there, still = sn.Scene([moving]).at(when), sn.Scene([obstacle])
    np.testing.assert_allclose(there.distance(POINTS), still.distance(own), atol=1e-9)
    np.testing.assert_allclose(there.at_most(POINTS), still.at_most(own), atol=1e-9)
    np.testing.assert_allclose(measure(there.obstacles[0], POINTS), measure(obstacle, own), atol=1e-9)
    if not isinstance(obstacle, sn.Field):  # whose gradient is one of differences
        np.testing.assert_allclose(there.gradient(POINTS), still.gradient(own) @ pose[:3, :3].T, atol=1e-6)


def test_positions_are_linear_and_turns_even_between_times() -> None:
    moving = sn.Moving(sn.Sphere((0, 0, 0), 1.0), TIMES, POSITIONS, TURNS)
    when = np.linspace(0.0, 3.0, 31)
    turns = Rotation.from_quat(np.roll(TURNS, -1, axis=1))
    poses = moving.pose(when)
    np.testing.assert_allclose(poses[:, :3, :3], Slerp(TIMES, turns)(when).as_matrix(), atol=1e-12)
    places = np.stack([np.interp(when, TIMES, column) for column in POSITIONS.T], axis=-1)
    np.testing.assert_allclose(poses[:, :3, 3], places, atol=1e-12)
    np.testing.assert_array_equal(moving.pose(-5.0), moving.pose(0.0))
    np.testing.assert_array_equal(moving.pose(5.0), moving.pose(3.0))


def test_poses_may_be_given_in_several_ways() -> None:
    ball = sn.Sphere((1, 0, 0), 0.1)
    turns = Rotation.from_rotvec([(0, 0, 0), (0, 0, 1), (0, 0, 2)])
    one = sn.Moving(ball, TIMES, POSITIONS, turns)
    poses = np.zeros((3, 4, 4))
    poses[:, :3, :3], poses[:, :3, 3], poses[:, 3, 3] = turns.as_matrix(), POSITIONS, 1.0
    assert one.equals(sn.Moving(ball, TIMES, poses=poses))
    same = sn.Moving(ball, TIMES, POSITIONS, xyzw=turns.as_quat())
    np.testing.assert_allclose(present(same.rotations), present(one.rotations))
    spinning = sn.Moving(ball, TIMES, rotations=turns)
    there = spinning.at(1.0)
    assert isinstance(there, sn.Sphere)
    np.testing.assert_allclose(there.center, [np.cos(1.0), np.sin(1.0), 0.0])
    shifted = np.tile(np.eye(4), (3, 1, 1))
    assert sn.Moving(ball, TIMES, poses=shifted).rotations is None
    assert sn.Moving(ball, [2.0], [(0, 0, 1)]).at(-7.0).equals(sn.Sphere((1, 0, 1), 0.1))


def test_a_moving_scene_has_distances_and_solutions_at_a_time_only() -> None:
    scene = sn.Scene([sn.Sphere((9, 0, 0), 1.0), sn.Moving(sn.Sphere((0, 0, 0), 1.0), [0, 1], [(9, 0, 0), (9, 9, 0)])])
    robot = sn.Robot.uniform(2, (0.8, 1.2))
    for ask in (lambda: scene.distance([0, 0, 0]), lambda: sn.solve(robot, sn.Target((0, 0, 2)), scene)):
        error = refused("scene", ask)
        assert "scene.at(t)" in str(error)
        assert "sphere[1] moves" in str(error)
    assert sn.solve(robot, sn.Target((0, 0, 2)), scene.at(0.5)).solved
    assert scene.at(0.5).at(0.7).equals(scene.at(0.5))
    assert "move" in repr(scene)


def test_what_is_wrong_is_refused_by_name() -> None:
    ball = sn.Sphere((0, 0, 0), 1.0)
    refused("obstacle", lambda: sn.Moving(sn.Moving(ball, [0], [(0, 0, 0)]), [0], [(0, 0, 0)]))
    refused("obstacle", lambda: sn.Moving((0, 0, 0), [0], [(0, 0, 0)]))  # type: ignore[arg-type]
    refused("times[1]", lambda: sn.Moving(ball, [0, 0], [(0, 0, 0)] * 2))
    refused("times", lambda: sn.Moving(ball, [], np.zeros((0, 3))))
    refused("positions", lambda: sn.Moving(ball, [0, 1], [(0, 0, 0)]))
    refused("positions", lambda: sn.Moving(ball, [0, 1]))
    refused("rotations", lambda: sn.Moving(ball, [0, 1], rotations=[(1, 0, 0, 0)]))
    refused("poses", lambda: sn.Moving(ball, [0], [(0, 0, 0)], poses=[np.eye(4)]))
    refused("poses", lambda: sn.Moving(ball, [0], poses=[np.zeros((4, 4))]))
    refused("t", lambda: sn.Moving(ball, [0], [(0, 0, 0)]).at(float("nan")))


def test_a_moved_scene_is_the_scene_made_anew() -> None:
    rng = np.random.default_rng(0)
    cloud = sn.PointCloud(rng.normal(size=(50, 3)), 0.05)
    obstacles = [cloud, sn.Sphere((3, 0, 0), 0.5), sn.Box((0, 3, 0), (1, 1, 1)), sn.Sphere((0, 0, 3), 0.5)]
    points = rng.normal(size=(200, 3)) * 3
    snapshot = sn.Scene(obstacles).snapshot()
    before, moved = snapshot.distance(points), snapshot
    for _ in range(5):
        box = sn.Box(rng.normal(size=3) * 3, (1, 2, 1))
        obstacles[2] = box
        moved = moved.replaced(2, box)
        assert moved.obstacles == tuple(obstacles)
        np.testing.assert_array_equal(moved.distance(points), sn.Scene(obstacles).distance(points))
        np.testing.assert_array_equal(moved.group, sn.Scene(obstacles).group)
    np.testing.assert_array_equal(snapshot.distance(points), before)
