"""Among many obstacles a hierarchy finds what asking one after the other finds, to the last bit."""

import math

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels import tables as t
from sinuous.kernels.body.pieces import FEW, MANY, few_near, near
from sinuous.kernels.fields import distances
from sinuous.kernels.fields.solids import EXACT, INTERPOLATED, LOWER_BOUND, UPPER_BOUND
from sinuous.scene.obstacles import Obstacle, Primitive
from tests.helpers import Floats, kernel_scene, vec
from tests.scene import shapes

SIDE = 6.0


def some(count: int, rng: np.random.Generator) -> list[Primitive]:
    """Obstacles of all kinds, long and oblique ones among them, some of them alike."""
    made: list[Primitive] = []
    for i in range(count):
        place, way, kind = SIDE * rng.random(3), rng.normal(size=3), i % 7
        if kind == 0:
            made.append(sn.Sphere(place, rng.uniform(0.1, 0.4)))
        elif kind == 1:
            made.append(sn.Sphere(np.round(place), 0.5))
        elif kind == 2:
            made.append(sn.Box(place, rng.uniform(0.1, 1.0, 3), rng.normal(size=4)))
        elif kind == 3:
            made.append(sn.Box(place, (3.0, 2.0, 0.05), rng.normal(size=4)))
        elif kind == 4:
            made.append(sn.Cylinder(place - way, place + way, 0.1))
        else:
            made.append(sn.Capsule(place - 2.0 * way, place + 2.0 * way, 0.05))
    return made


def many(rng: np.random.Generator) -> list[Obstacle]:
    """The same with meshes, clouds and grids, moved and not, and with some that have no end."""
    vertices, faces = shapes.cube(0.6)
    bar = sn.Mesh(vertices * (6.0, 0.3, 0.3) + SIDE * rng.random(3), faces)
    pose = sn.pose(SIDE * rng.random(3), rotation=rng.normal(size=4))
    cells = rng.random((3, 4, 3)) < 0.3
    scene = sn.Scene([bar.named("bar"), sn.PointCloud(SIDE * rng.random((30, 3)), 0.1, name="cloud")])
    scene.move("bar", pose[:3, 3], pose[:3, :3])
    scene.move("cloud", (0.5, 0.0, 0.2), rng.normal(size=4))
    return [
        *some(40, rng),
        sn.HalfSpace((0.0, 0.0, -0.3), (0.1, 0.0, 1.0)),
        *scene.obstacles,
        sn.Mesh(vertices + SIDE * rng.random(3), faces),
        sn.PointCloud(SIDE * rng.random((20, 3)), 0.2),
        sn.Grid(cells, (1.0, 2.0, 0.5), 0.4),
        sn.Box((3.0, 3.0, 3.0), (9.0, 9.0, 9.0), inside=True),
        *some(20, rng),
    ]


def both(scene: sn.Scene, cells: bool = False) -> tuple[distances.Scene, distances.Scene]:
    """A scene as kernels take it, perhaps with cells that list who is near, and the same without its hierarchy."""
    plain = kernel_scene(scene)
    if cells:
        scene.snapshot().list_near(np.full(3, 0.4 * SIDE), 0.4 * SIDE, 0.3)
    own = kernel_scene(scene)
    assert (own.store[t.HIERARCHY_CELLS] > 0.0) == cells
    plain.store[t.HIERARCHY_OBSTACLES] = -1.0
    assert distances.is_large(own)
    assert not distances.is_large(plain)
    return own, plain


def places(count: int, rng: np.random.Generator) -> Floats:
    return rng.uniform(-1.0, SIDE + 1.0, (count, 3))


@pytest.mark.parametrize("cells", [False, True])
def test_the_closest_obstacle_is_the_first_of_those_that_are_as_close(cells: bool) -> None:
    rng = np.random.default_rng(0)
    for obstacles in (some(80, rng), many(rng)):
        own, plain = both(sn.Scene(obstacles), cells)
        for p in map(vec, places(15, rng)):
            for mode in (INTERPOLATED, LOWER_BOUND, EXACT, UPPER_BOUND):
                for reach in (0.3, 1.0, math.inf):
                    found, expected = distances.closest(own, p, reach, mode), distances.closest(plain, p, reach, mode)
                    if expected[0] < reach:
                        assert found == expected
                    else:
                        assert found[0] >= reach


@pytest.mark.parametrize("cells", [False, True])
def test_those_are_listed_that_are_near(cells: bool) -> None:
    rng = np.random.default_rng(1)
    own, plain = both(sn.Scene(many(rng)), cells)
    among, expected = np.zeros((2, len(own.table)), np.int64)
    counts = set()
    for p in map(vec, places(15, rng)):
        for reach in (0.05, 0.5, 3.0):
            count, few = near(plain, p, reach, expected)[0], few_near(own, p, reach, among)[0]
            assert few == (count if count <= FEW else MANY)
            assert near(own, p, reach, among)[0] == count
            np.testing.assert_array_equal(among[:count], expected[:count])
            counts.add(count)
    assert min(counts) <= 1
    assert max(counts) > FEW


@pytest.mark.parametrize("count", [60, 100, 200])  # so the first step of a walk goes one, two and three levels down
def test_machine_code_finds_what_some_obstacles_at_a_time_find(count: int) -> None:
    rng = np.random.default_rng(count)
    obstacles = some(count, rng)
    scene = sn.Scene([sn.HalfSpace((0.0, 0.0, -9.0), (0.0, 0.0, 1.0)), *obstacles])
    walk = np.cumsum(rng.normal(scale=0.1, size=(100, 3)), axis=0)
    points = np.concatenate([places(100, rng), walk, 1e4 * places(5, rng)])
    for index in (1, 6):
        groups = [sn.Scene(scene.obstacles[i : i + 40]) for i in range(0, count + 1, 40)]
        apart = np.min([own.distance(points) for own in groups], axis=0)
        np.testing.assert_allclose(scene.distance(points), apart, rtol=1e-13, atol=1e-13)  # rows are rounded otherwise
        scene.move(scene.name(index), (3.0, 3.0, 3.0))


@pytest.mark.parametrize("count", [t.MANY_OBSTACLES - 1, t.MANY_OBSTACLES])
def test_few_obstacles_have_no_hierarchy(count: int) -> None:
    boxes = [sn.Box((3.0 * i, 0.0, 0.0), (2.0, 2.0, 2.0)) for i in range(count)]
    balls = [sn.Sphere((3.0 * i, 0.0, 0.0), 1.0) for i in range(count)]
    for obstacles, large in ((boxes, count >= t.MANY_OBSTACLES), (balls, False)):
        scene = sn.Scene(obstacles)
        assert distances.is_large(kernel_scene(scene)) == large
        assert scene.distance((3.0 * count, 0.0, 0.0)) == 2.0
        moved = scene.snapshot().replaced(1, sn.Box((0.0, 9.0, 0.0), (2.0, 2.0, 2.0)))
        assert moved.distance((0.0, 8.0, 1.0)) == 0.0


def test_a_scene_of_which_a_part_changed_is_the_scene_made_anew() -> None:
    rng = np.random.default_rng(7)
    obstacles = many(rng)
    names = [f"part {i}" for i in range(len(obstacles))]
    scene = sn.Scene([own.named(name) for own, name in zip(obstacles, names, strict=True)])
    scene.prepare()
    points = places(200, rng)
    for i in (2, 41, 42, 43, 3, 60, 2):
        scene.move(names[i], rng.normal(size=3), rng.normal(size=4))
        again = sn.Scene(scene.obstacles).distance(points)  # rows made together differ by what arithmetic does
        np.testing.assert_allclose(scene.distance(points), again, rtol=0.0, atol=1e-14)
    for count in (20, 70):
        cloud = next(own for own in scene.obstacles if isinstance(own, sn.PointCloud) and own.place is None)
        scene.update(SIDE * rng.random((count, 3)), 0.1, name=cloud.name)
        again = sn.Scene(scene.obstacles).distance(points)
        np.testing.assert_allclose(scene.distance(points), again, rtol=0.0, atol=1e-14)
