"""Every family: the hidden shape is feasible by an independent check, seeds make places again, all robots occur."""

import math
from functools import cache

import numpy as np
import pytest
import trimesh

import sinuous as sn
from benchmarks.judges.collisions import Body
from benchmarks.judges.judge import Flags
from benchmarks.places import FAMILIES, Place, make, place
from benchmarks.places.around.spheres import spheres
from benchmarks.places.parts.robots import long_robot, robot_of, stout_robot, various_robot
from benchmarks.places.place import Sketch, settle
from benchmarks.problems import random_configurations
from sinuous.base.checks import Floats
from sinuous.measures.body import arc_poses
from sinuous.measures.obstacles import measure
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.obstacles import Obstacle, Sphere
from sinuous.scene.point_cloud import PointCloud
from tests.cases import with_each

made_once = cache(make)
"""To prepare a place takes seconds: tests that only look at it share it."""

DRAWN = [name for name in FAMILIES if not name.startswith("p")] + ["pipe 1.3", "pipe 1.6 scan", "plates"]
DRAWN += ["pipe between", "pipe between scan"]


def backbone(made: Place) -> tuple[Floats, Floats, list[Floats]]:
    """Points of the hidden shape beyond the mount, radii there, and the poses of all ends, by matrix exponentials."""
    ends, points, radii, before = [made.robot.base], [], [], 0.0
    arcs = arc_poses(made.hidden_q, 60)
    for arc, coordinates, radius in zip(arcs, made.hidden_q, made.robot.radii, strict=True):
        poses = ends[-1] @ arc
        exposed = before + np.linspace(0.0, coordinates[2], 61) >= made.robot.mount
        points.append(poses[exposed, :3, 3])
        radii.append(np.full(exposed.sum(), radius))
        ends.append(poses[-1])
        before += coordinates[2]
    ends[-1] = ends[-1] @ made.robot.tool
    return np.concatenate(points), np.concatenate(radii), ends


def distance(obstacle: Obstacle, points: Floats) -> Floats:
    if isinstance(obstacle, Mesh):
        solid = trimesh.Trimesh(obstacle.vertices, obstacle.faces, process=False)
        distances: Floats = trimesh.proximity.closest_point_naive(solid, points)[1]  # type: ignore[no-untyped-call]
        return distances * np.where(inside(solid, points), -1.0, 1.0)
    if isinstance(obstacle, PointCloud):
        gaps = np.linalg.norm(points[:, None] - obstacle.points, axis=-1) - obstacle.radii
        nearest: Floats = gaps.min(axis=1)
        return nearest
    return measure(obstacle, points)


def inside(solid: trimesh.Trimesh, points: Floats) -> Flags:
    """By the solid angles that the triangles take up (van Oosterom and Strackee 1983)."""
    a, b, c = (solid.triangles[None, :, k] - points[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=-1)
    cosine = la * lb * lc + (a * b).sum(-1) * lc + (b * c).sum(-1) * la + (c * a).sum(-1) * lb
    within: Flags = np.abs(2.0 * np.arctan2(volume, cosine).sum(axis=1)) > 2.0 * np.pi
    return within


@pytest.mark.parametrize("family", DRAWN)
def test_the_hidden_shape_is_feasible(family: str) -> None:
    made = made_once(family, 10)
    robot, q = made.robot, made.hidden_q
    points, radii, ends = backbone(made)
    some = slice(None, None, max(1, len(points) // 25))
    for obstacle in made.scene.obstacles:
        assert (distance(obstacle, points[some]) >= radii[some]).all()
    assert robot.excess(q) <= 1e-12
    for target in made.targets:
        end = ends[-1 if target.segment is None else target.segment]
        assert target.position is not None
        np.testing.assert_allclose(end[:3, 3], target.position, atol=1e-9 * robot.mean_length)
        if target.direction is not None:
            np.testing.assert_allclose(end[:3, 2], target.direction, atol=1e-9)


@pytest.mark.parametrize("family", ["pipe 2.2", "duct", "pipe 1.6 scan", "duct scan"])
def test_nobody_gets_out_of_what_is_closed(family: str) -> None:
    """Shapes drawn at random leave the pipe, through its wall: the judge sees every one."""
    made = made_once(family, 10)
    drawn = random_configurations(made.robot, 12, np.random.default_rng(0))
    body = Body(made.robot, made.scene, thorough=True)
    assert all(body.overlaps(drawn))
    assert body.overlaps(made.hidden_q[None]) == [False]


@pytest.mark.parametrize("family", ["spheres 12", "drum scan", "duct", "two doors mesh", "small world", "p4 pose"])
def test_a_seed_makes_its_place_again(family: str) -> None:
    first, again, other = made_once(family, 10), make(family, 10), made_once(family, 13)
    np.testing.assert_array_equal(first.hidden_q, again.hidden_q)
    for one, same_one in zip(first.targets, again.targets, strict=True):
        np.testing.assert_array_equal(one.table, same_one.table)
    assert first.target.position is not None
    assert other.target.position is not None
    assert not np.array_equal(first.target.position, other.target.position)
    for mine, same in zip(first.scene.obstacles, again.scene.obstacles, strict=True):
        if isinstance(mine, Mesh) and isinstance(same, Mesh):
            np.testing.assert_array_equal(mine.vertices, same.vertices)
        if isinstance(mine, PointCloud) and isinstance(same, PointCloud):
            np.testing.assert_array_equal(mine.points, same.points)


MESHED = ["pipe 1.3", "pipe 2.2", "plates", "drum", "duct", "open pipe 1.3", "bore", "cells mesh", "cells pipe"]
MESHED += ["two tubes", "funnel"]


@with_each(("family", "seed"), [("branches", 10), ("duct", 13), *((family, 10) for family in MESHED)])
def test_meshes_are_solids_without_flaws(family: str, seed: int) -> None:
    for obstacle in made_once(family, seed).scene.obstacles:
        if isinstance(obstacle, Mesh):
            assert obstacle.watertight
            assert obstacle.defects == ()
            solid = trimesh.Trimesh(obstacle.vertices, obstacle.faces, process=False)
            assert solid.is_watertight
            assert solid.volume > 0.0


def test_twenty_seeds_have_all_robots() -> None:
    robots = [robot_of(seed, np.random.default_rng(seed)) for seed in range(20)]
    stages = [robot.segments[0].max_bend == 0.0 for robot in robots]
    bending = [len(robot) - stage for robot, stage in zip(robots, stages, strict=True)]
    extensible = [robot.segments[-1].length[0] < robot.segments[-1].length[1] for robot in robots]
    assert len(set(zip(bending, extensible, stages, strict=True))) == 20
    assert set(bending) == {3, 5, 8, 12, 20}


def test_half_of_the_targets_ask_for_a_direction_whatever_the_robot() -> None:
    asked = [make("spheres 12", seed) for seed in range(40)]
    assert sum(made.target.direction is not None for made in asked) == 20
    for seed in range(20):
        assert (asked[seed].target.direction is None) != (asked[seed + 20].target.direction is None)


def test_a_shape_that_touches_is_drawn_again() -> None:
    tried = []

    def draw(seed: int, rng: np.random.Generator) -> Sketch:
        sketch = spheres(12, seed, rng)
        tried.append(sketch)
        blocked = Sphere(sketch.robot.base[:3, 3], 0.5 * min(sketch.robot.radii))
        return sketch._replace(obstacles=[*sketch.obstacles, blocked] if len(tried) < 3 else sketch.obstacles)

    made = settle("spheres 12", 0, draw)
    assert len(tried) == 3
    np.testing.assert_array_equal(made.hidden_q, tried[2].q)


def test_a_shape_that_touches_itself_is_drawn_again() -> None:
    hairpin = np.array([[0.0, 0.0, 1.0], [math.pi, 0.0, 0.3], [0.0, 0.0, 1.0]])
    tried = list[float]()

    def draw(_seed: int, _rng: np.random.Generator) -> Sketch:
        tried.append(0.09 if len(tried) == 2 else 0.1)
        return Sketch(sn.Robot.uniform(3, (0.1, 1.0), radius=tried[-1]), [], hairpin)

    settle("hairpins", 0, draw)
    assert tried == [0.1, 0.1, 0.09]


def test_various_robots_are_various() -> None:
    made = [various_robot(seed, np.random.default_rng(seed)) for seed in range(60)]
    slender = [max(robot.radii) / max(segment.length[1] for segment in robot.segments[1:]) for robot in made]
    assert min(slender) < 0.06
    assert max(slender) > 0.1
    assert 15 < sum(min(robot.radii) < max(robot.radii) for robot in made) < 45
    assert 10 < sum(not np.array_equal(robot.tool, np.eye(4)) for robot in made) < 30
    assert {len(stout_robot(seed, np.random.default_rng(seed)).segments) for seed in range(20)} == {3, 4, 5, 6, 8, 9}
    assert {len(long_robot(seed, np.random.default_rng(seed)).segments) for seed in range(8)} == {20, 21}


def test_some_are_asked_for_an_elbow() -> None:
    made = [make("channel", seed) for seed in range(20)]
    elbows = [place for place in made if len(place.targets) == 2]
    assert 0 < len(elbows) < len(made)
    assert all(place.targets[0].segment is not None and place.target.segment is None for place in elbows)


def test_a_family_without_room_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(place, "PATIENCE", 3)
    with pytest.raises(RuntimeError, match="no place for seed 4"):
        settle("nowhere", 4, lambda _seed, _rng: None)
