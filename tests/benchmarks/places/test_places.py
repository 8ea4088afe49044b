"""Every family: the hidden shape is feasible by an independent check, and a seed makes its place again."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import trimesh

import sinuous as sn
from benchmarks.judges.clearances import least_clearance, overlaps
from benchmarks.judges.judge import Flags
from benchmarks.motion import known
from benchmarks.places import FAMILIES, Place, make
from benchmarks.problems import random_configurations
from sinuous.base.checks import Floats
from sinuous.measures.body import arc_poses
from sinuous.measures.obstacles import measure
from sinuous.scene.obstacles import Obstacle

made_once = cache(make)
"""To prepare a place takes seconds: tests that only look at it share it."""

DRAWN = [name for name in FAMILIES if not name.startswith("p") and not name.endswith("scan")] + ["pipe 1.3", "plates"]
DRAWN += ["pipe between", "pipe 1.6 scan", "drum scan"]


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
    if isinstance(obstacle, sn.Mesh):
        solid = trimesh.Trimesh(obstacle.vertices, obstacle.faces, process=False)
        distances: Floats = trimesh.proximity.closest_point_naive(solid, points)[1]  # type: ignore[no-untyped-call]
        return distances * np.where(inside(solid, points), -1.0, 1.0)
    if isinstance(obstacle, sn.PointCloud):
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
def test_the_hidden_shape_is_feasible_and_meshes_are_solids(family: str) -> None:
    made = made_once(family, {"assembly": 15, "gyroid": 15}.get(family, 10))  # others of these take twice as long
    robot, q = made.robot, made.hidden_q
    assert robot.excess(q) <= 1e-12
    if robot.joints:
        robot, q = robot.arm_at(q)
    points, radii, ends = backbone(replace(made, robot=robot, hidden_q=q))
    some = slice(None, None, max(1, len(points) // 25))
    for obstacle in made.scene.obstacles:
        assert (distance(obstacle, points[some]) >= radii[some]).all()
        if isinstance(obstacle, sn.Mesh):
            assert obstacle.watertight
            assert obstacle.defects == ()
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
    assert overlaps(made.robot, made.scene, drawn).all()
    assert not overlaps(made.robot, made.scene, made.hidden_q[None]).any()


@pytest.mark.parametrize("family", ["spheres 12", "small world", "p4 pose"])
def test_a_seed_makes_its_place_again(family: str) -> None:
    first, again, other = made_once(family, 10), make(family, 10), made_once(family, 13)
    np.testing.assert_array_equal(first.hidden_q, again.hidden_q)
    np.testing.assert_array_equal(first.target.table, again.target.table)
    assert not np.array_equal(first.target.table, other.target.table)


@pytest.mark.parametrize(
    "family", ["40 balls, leading", "plates, wandering", "two doors", "door in, from another shape"]
)
def test_a_motion_is_hidden_in_places_to_plan_into(family: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What `make` has looked at with few samples is clear at others, too, and what stands around is near."""
    monkeypatch.setattr("benchmarks.judges.judge.A_STEP", 10)
    monkeypatch.setattr(known, "LOOKS", 4)
    place = known.make(family, 7)
    radius, gaps = max(place.robot.radii), least_clearance(place.robot, place.scene, place.knots)
    assert 0.1 * radius < gaps.min() < radius
