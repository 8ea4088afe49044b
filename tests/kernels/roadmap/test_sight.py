"""What is in sight of what, against points all along the line."""

import numpy as np
import pytest

from sinuous.kernels.roadmap.sight import KEPT, STEPS, cuts, cutting, in_sight
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Box
from sinuous.scene.scene import Scene
from sinuous.solver.routing.edges import walls_of
from tests.helpers import Floats, kernel_scene, vec
from tests.kernels.freespace.places import RADIUS, grid

NO_TRIANGLES = np.empty((0, 12))


def boxes(seed: int) -> list[Box]:
    rng = np.random.default_rng(seed)
    return [Box(rng.uniform(-1, 1, 3), rng.uniform(0.1, 0.8, 3), rng.normal(size=4)) for _ in range(6)]


def lines(seed: int, count: int) -> Floats:
    return np.random.default_rng(100 + seed).uniform(-1.5, 1.5, (count, 2, 3))


def along(line: Floats) -> Floats:
    return np.linspace(line[0], line[1], 2000)


@pytest.mark.parametrize("seed", range(3))
def test_a_line_that_keeps_away_is_in_sight_and_one_that_does_not_is_not(seed: int) -> None:
    scene = Scene(boxes(seed))
    packed, seen = kernel_scene(scene), 0
    for line in lines(seed, 60):
        least = scene.distance(along(line)).min() / RADIUS
        visible, looks = in_sight(packed, grid(), vec(line[0]), vec(line[1]))
        assert looks > 0
        assert visible or least < KEPT + 1e-6
        assert not visible or least > KEPT - 0.08  # no step is shorter than 0.15 radii
        seen += visible
    assert 5 < seen < 55


def test_a_thin_body_goes_along_a_wall_in_steps_that_can_be_counted() -> None:
    wall = kernel_scene(Scene([Box((0.0, 0.0, -1.0), (20.0, 20.0, 2.0))]))
    visible, looks = in_sight(wall, grid()._replace(radius=1e-9), (-9.0, 0.0, 1e-9), (9.0, 0.0, 1e-9))
    assert visible
    assert STEPS <= looks <= STEPS + 1


@pytest.mark.parametrize("seed", range(3))
def test_a_box_cuts_a_line_where_points_of_it_are_within(seed: int) -> None:
    scene = Scene(boxes(seed))
    packed = kernel_scene(scene)
    recent = np.full(3, -1)
    for line in lines(seed, 60):
        found, asked = cutting(packed, NO_TRIANGLES, vec(line[0]), vec(line[1]), recent)
        assert 1 <= asked <= 3 + 6
        assert found in (-1, recent[0])
        inside = scene.snapshot().distance_to(found, along(line))[0] if found >= 0 else scene.distance(along(line))
        assert inside.min() < 1e-3 if found >= 0 else inside.min() >= 0.0


@pytest.mark.parametrize("seed", range(3))
def test_faces_are_crossed_where_the_line_changes_sides(seed: int) -> None:
    corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    faces += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    cube = Scene([Mesh(corners, faces)])
    triangles, nothing = walls_of(cube.snapshot()).triangles, kernel_scene(Scene())
    crossed = 0
    recent = np.full(4, -1)
    for line in lines(seed, 60):
        inside = np.abs(along(line)).max(axis=1) < 0.5
        found, _ = cutting(nothing, triangles, vec(line[0]), vec(line[1]), recent)
        assert found < 0 or cuts(nothing, triangles, found, vec(line[0]), vec(line[1]))
        assert (found >= 0) == (inside[1:] != inside[:-1]).any()
        crossed += found >= 0
    assert crossed > 3


def test_what_cut_a_line_of_late_is_asked_first_and_each_is_there_once() -> None:
    packed = kernel_scene(Scene([Box((0.0, 0.0, z), (1.0, 1.0, 0.1)) for z in (0.0, 1.0, 2.0, 3.0)]))
    recent = np.full(2, -1)

    def ask(z: float, which: int, looks: int) -> None:
        line = (0.0, 0.0, z - 0.5), (0.0, 0.0, z + 0.5)
        assert cutting(packed, NO_TRIANGLES, *line, recent) == (which, looks)

    ask(2.0, 2, 1 + 4)
    ask(2.0, 2, 1)
    ask(1.0, 1, 2 + 4)
    assert recent.tolist() == [1, 2]
    ask(2.0, 2, 2)
    assert recent.tolist() == [2, 1]
    ask(3.0, 3, 2 + 4)
    assert recent.tolist() == [3, 2]
    ask(9.0, -1, 2 + 4)
    assert recent.tolist() == [3, 2]


def test_nothing_is_in_sight_that_lies_behind_an_end() -> None:
    ends = grid(start=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0), goal=(3.0, 0.0, 0.0), back=(-1.0, 0.0, 0.0), turn=0.8)
    nothing, start = kernel_scene(Scene()), (0.0, 0.0, 0.0)
    assert in_sight(nothing, ends, start, (0.0, 0.0, 1.0))[0]
    assert in_sight(nothing, ends, start, (1.0, 0.0, 0.0))[0]
    assert not in_sight(nothing, ends, start, (0.0, 0.0, -1.0))[0]
    assert not in_sight(nothing, ends, (-1.0, 0.0, -0.5), (1.0, 0.0, -0.5))[0]
    assert in_sight(nothing, ends, (-1.0, 0.0, -0.9), (1.0, 0.0, -0.9))[0]
    assert not in_sight(nothing, ends, (3.5, 1.0, 0.0), (3.5, -1.0, 0.0))[0]
