"""The union of obstacles: nearest distances of whole batches, names, and bad input."""

import math
import pickle
from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

import sinuous as sn
from tests.helpers import Floats, random_rotation, refused, refused_each, with_each
from tests.scene.shapes import cube, together

OBSTACLES = [
    sn.Sphere((0, 0, 0), 1),
    sn.Box((3, 0, 0), (1, 2, 3)),
    sn.Capsule((0, 3, 0), (0, 5, 1), 0.5, name="pipe"),
    sn.HalfSpace((0, 0, -4), (0, 0, 1)),
]
SCENE = sn.Scene(OBSTACLES)


@with_each("lead", [(), (5,), (2, 3), (0,), (2, 0)])
def test_a_batch_is_its_members_one_by_one(lead: tuple[int, ...]) -> None:
    points = np.random.default_rng(1).normal(size=(*lead, 3))
    distance, gradient, nearest = SCENE.distance(points), SCENE.gradient(points), SCENE.nearest(points)
    assert distance.shape == nearest.shape == lead
    assert gradient.shape == (*lead, 3)
    for index in np.ndindex(*lead):
        assert distance[index] == SCENE.distance(points[index])
        assert nearest[index] == SCENE.nearest(points[index])
        np.testing.assert_array_equal(gradient[index], SCENE.gradient(points[index]))


def test_an_empty_scene_is_infinitely_far() -> None:
    empty = sn.Scene()
    assert len(empty) == 0
    assert empty.distance((0, 0, 0)) == math.inf
    assert empty.nearest((0, 0, 0)) == -1
    np.testing.assert_array_equal(empty.gradient((0, 0, 0)), np.zeros(3))
    np.testing.assert_array_equal(empty.distance(np.zeros((2, 3))), [math.inf, math.inf])


def test_what_is_no_obstacle_is_refused() -> None:
    refused("scene[1]", lambda: sn.Scene([OBSTACLES[0], "sphere"]), "an obstacle")  # type: ignore[list-item]
    refused_each("scene", (None, 3, "room.yaml"), sn.Scene)


@with_each(
    "value",
    ["abc", None, 3.0, (1.0, 2.0), [[1.0, 2.0], [3.0]], (1.0, math.nan, 0.0), (True, False, True), np.zeros((3, 2))],
)
def test_bad_points_are_refused(value: Any) -> None:
    for call in (SCENE.distance, SCENE.gradient, SCENE.nearest):
        refused("points", partial(call, value), "3)")


def cloud(seed: int, count: int = 300, shift: float = 0.0) -> Floats:
    return np.random.default_rng(seed).normal([shift, 0.0, 0.0], size=(count, 3))


def test_an_update_replaces_the_cloud() -> None:
    wall, points = sn.HalfSpace((0, 0, -9), (0, 0, 1)), np.random.default_rng(7).normal(size=(50, 3)) * 3.0
    scene = sn.Scene([wall, sn.PointCloud(cloud(1), 0.1, name="camera")])
    scene.distance(points)
    for count, shift in ((50, 2.0), (4000, -1.0), (1, 0.0)):
        scene.update(cloud(2, count, shift))
        fresh = sn.Scene([wall, sn.PointCloud(cloud(2, count, shift), 0.1)])
        np.testing.assert_array_equal(scene.distance(points), fresh.distance(points))
        assert [scene.name(i) for i in range(2)] == ["half_space[0]", "camera"]
    sizes = np.linspace(0.0, 0.3, 300)
    scene.update(cloud(3), sizes)
    np.testing.assert_array_equal(
        scene.distance(points), sn.Scene([wall, sn.PointCloud(cloud(3), sizes)]).distance(points)
    )
    refused("radius", lambda: scene.update(cloud(4)), "missing")


def test_an_update_leaves_out_what_is_not_finite_and_what_is_the_robot() -> None:
    scene = sn.Scene([sn.PointCloud(cloud(1), 0.01, name="camera")])
    places = cloud(2)
    places[5] = np.nan
    refused("points[5]", lambda: scene.update(places), "1 of 300 points are not finite")
    scene.update(places, invalid="drop")
    np.testing.assert_array_equal(scene.obstacles[0].points, np.delete(places, 5, axis=0))  # type: ignore[attr-defined]
    robot = sn.Robot.uniform(2, 1.0, 2.0, radius=0.05)
    solution = sn.solve(robot, sn.Target((0.6, 0.3, 1.5)))
    around = robot.backbone(solution.q, 40)[:, None] + 0.05 * np.array([(1, 0, 0), (0, 1, 0), (0, 0, -1)])
    wall = np.array([(1.5, y, 1.0) for y in np.linspace(-1, 1, 30)])
    seen = np.concatenate([around.reshape(-1, 3), wall])
    for shape in (solution, (robot, solution.q)):
        scene.update(seen, ignore_robot=shape, margin=0.01)
        np.testing.assert_array_equal(scene.obstacles[0].points, wall)  # type: ignore[attr-defined]
        assert sn.solve(robot, sn.Target((0.6, 0.3, 1.5)), scene, initial=solution.q).solved
    scene.update(seen)
    assert len(scene.obstacles[0].points) == len(seen)  # type: ignore[attr-defined]
    refused("ignore_robot", lambda: scene.update(seen, ignore_robot=solution.q), "a solution")  # type: ignore[arg-type]
    refused("margin", lambda: scene.update(seen, margin=-1.0))


def test_which_cloud_must_be_clear() -> None:
    two = sn.Scene([sn.PointCloud(cloud(1), 0.1, name="left"), sn.PointCloud(cloud(2, shift=9.0), 0.1)])
    refused("name", lambda: two.update(cloud(3)), "leaves open", "left, points[1]")
    refused("name", lambda: two.update(cloud(3), name="right"), "names no point cloud")
    refused("name", lambda: sn.Scene([sn.Sphere((0, 0, 0), 1)]).update(cloud(3)), "a scene with a point cloud")
    refused("points[3]", lambda: two.update([*cloud(1)[:3].tolist(), [0.0, 0.0, np.nan]], name="left"))
    two.update(cloud(3, shift=3.0), name="points[1]")
    np.testing.assert_array_equal(
        two.distance(cloud(4)),
        sn.Scene([sn.PointCloud(cloud(1), 0.1), sn.PointCloud(cloud(3, shift=3.0), 0.1)]).distance(cloud(4)),
    )


def test_of_sampled_distances_there_is_a_range() -> None:
    values = np.linalg.norm(np.argwhere(np.ones((9, 9, 9))) - 4.0, axis=1).reshape(9, 9, 9) - 2.0
    scene = sn.Scene([sn.Grid(values, (-4, -4, -4), 1.0), sn.Sphere((20, 0, 0), 1.0)])
    points = np.random.default_rng(5).uniform(-4, 4, (200, 3))
    true = np.linalg.norm(points, axis=1) - 2.0
    assert (scene.distance(points) <= true).all()
    assert (scene.at_most(points) >= true).all()
    beside = np.array([[19.0, 3.0, 0.0]])
    assert scene.at_most(beside) == pytest.approx(math.hypot(1.0, 3.0) - 1.0)
    assert scene.distance(beside) < 0.0, "so far from its samples a grid proves nothing"


def test_beside_nothing_a_snapshot_is_itself() -> None:
    snapshot = sn.Scene([sn.Sphere((5, 0, 0), 1)]).snapshot()
    assert snapshot.beside([]) is snapshot


def test_a_snapshot_beside_meshes_has_them_too_and_samples_nothing() -> None:
    scene = sn.Scene([sn.Sphere((0, 0, 0), 1.0, name="ball")]).snapshot()
    sheet = sn.Mesh([(3, -1, -1), (3, 1, -1), (3, 0, 1)], [(0, 1, 2)], thickness=0.2, name="sheet")
    both = scene.beside([sheet])
    points = np.random.default_rng(0).uniform(-4.0, 4.0, (200, 3))
    expected = np.minimum(scene.distance(points), sn.Scene([sheet]).distance(points))
    np.testing.assert_allclose(both.distance(points), expected, atol=1e-9)
    assert [both.name(i) for i in range(2)] == ["ball", "sheet"]
    assert both.memory < 10_000
    assert len(scene) == 1
    assert len(scene.beside([])) == 1


def test_an_obstacle_is_moved_as_a_whole() -> None:
    rng = np.random.default_rng(4)
    points, turn = rng.normal(size=(300, 3)), random_rotation(rng)
    probes = rng.normal(size=(100, 3)) * 2.0
    described = {"cloud": sn.PointCloud(points, 0.05, name="cloud"), "box": sn.Box((1, 0, 0), (1, 2, 3), name="box")}
    scene = sn.Scene(described.values())
    before = scene.snapshot()
    for name, obstacle in described.items():
        for shift in ((1, 2, 3), (4, 5, 6)):  # from where it is described, not from where it was
            scene.move(name, shift, turn)
        there = sn.Moving(obstacle, [0], [(4, 5, 6)], [turn]).at(0.0)
        assert next(each for each in scene.obstacles if each.name == name).equals(there)
        index = [each.name for each in scene.obstacles].index(name)
        own = (probes - (4, 5, 6)) @ turn
        expected = sn.Scene([obstacle]).distance(own)
        np.testing.assert_allclose(scene.snapshot().distance_to(index, probes)[0], expected, atol=1e-9)
    assert before.obstacles == tuple(described.values())
    scene.update(points + 1.0, name="cloud")
    scene.move("cloud", (1, 0, 0))
    moved = next(each for each in scene.obstacles if each.name == "cloud")
    assert isinstance(moved, sn.PointCloud)
    np.testing.assert_allclose(moved.points, points + np.array([2.0, 1.0, 1.0]))
    assert pickle.loads(pickle.dumps(scene)).equals(scene)
    refused("name", lambda: scene.move("nobody", (0, 0, 0)))
    refused("position", lambda: scene.move("box", (0, 0)))


def test_a_cloud_that_is_replaced_has_exact_distances_in_whatever_order() -> None:
    """Shifted a little, turned, and shuffled, so that its points are sorted anew."""
    rng = np.random.default_rng(5)
    points, probes = rng.normal(size=(3000, 3)), rng.normal(size=(200, 3)) * 2.0
    scene = sn.Scene([sn.PointCloud(points, 0.02)])
    for fresh in (points + 0.1, points @ random_rotation(rng).T, rng.permutation(points), points[:1000], points):
        scene.update(fresh)
        expected = cKDTree(fresh).query(probes)[0] - 0.02
        np.testing.assert_allclose(scene.distance(probes), expected, atol=1e-12)


@pytest.mark.parametrize("count", [47, 48])
def test_a_scene_is_crowded_by_bodies_however_they_are_given(count: int) -> None:
    """As obstacles, or as pieces of one solid; pieces of a shell are no bodies."""
    cubes = [cube(center=(3.0 * i, 0.0, 0.0)) for i in range(count)]
    boxes = [sn.Box((3 * i, 0, 0), (1, 1, 1)) for i in range(count)]
    for obstacles in ([sn.Mesh(*together(*cubes))], boxes):
        assert sn.Scene(obstacles).snapshot().is_crowded == (count == 48)
    opened = [(vertices, faces[1:]) for vertices, faces in cubes]
    assert not sn.Scene([sn.Mesh(*together(*opened), thickness=0.1)]).snapshot().is_crowded
