"""Obstacles that are moved and resized by hand: a rigid motion moves what they are, and nothing else."""

from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.errors import InputError
from sinuous.scene.obstacles import Obstacle
from sinuous.view.page.edits import KINDS, make_obstacle, move_obstacle, pose_of, resize_obstacle, sizes_of
from tests.helpers import Floats, random_pose

RNG = np.random.default_rng(0)
TETRAHEDRON = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
SOLIDS: list[Obstacle] = [
    sn.Sphere((1, 2, 3), radius=0.5, inside=True, name="ball"),
    sn.Box((1, 0, 0), (1, 2, 3), rotation=(1, 2, 3, 4), name="crate"),
    sn.Capsule((0, 0, 0), (1, 2, 0), radius=0.3),
    sn.Cylinder((0, 1, 0), (0, 0, 2), radius=0.4),
    sn.HalfSpace((0, 0, -1), (1, 2, 3)),
    sn.Mesh(*TETRAHEDRON, name="tooth"),
    sn.PointCloud([[0, 0, 0], [1, 1, 0]], radius=[0.1, 0.2]),
]


def distance(obstacle: Obstacle, points: Floats) -> Floats:
    return sn.Scene([obstacle]).distance(points)


@pytest.mark.parametrize("obstacle", SOLIDS, ids=lambda obstacle: obstacle.kind)
def test_a_rigid_motion_carries_the_distances_along(obstacle: Obstacle) -> None:
    motion, points = random_pose(RNG, 2.0), RNG.normal(size=(50, 3))
    moved = move_obstacle(obstacle, motion)
    there = points @ motion[:3, :3].T + motion[:3, 3]
    np.testing.assert_allclose(distance(moved, there), distance(obstacle, points), atol=1e-9)
    assert moved.name == obstacle.name
    assert getattr(moved, "inside", None) == getattr(obstacle, "inside", None)


def test_what_is_from_a_file_stays_from_there(tmp_path: Path) -> None:
    np.save(tmp_path / "scan.npy", RNG.normal(size=(20, 3)))
    cloud = sn.PointCloud.load(tmp_path / "scan.npy", 0.1, scale=2.0, position=(1, 0, 0))
    moved = move_obstacle(cloud, random_pose(RNG))
    assert moved.source is not None
    again = sn.PointCloud.load(moved.source.file, **moved.source.arguments)
    assert again.equals(moved)


def test_grids_move_unless_a_file_says_where_they_are(tmp_path: Path) -> None:
    values = np.ones((3, 3, 3), bool)
    shift = np.eye(4)
    shift[:3, 3] = 5.0
    grid = move_obstacle(sn.Grid(values, (0, 0, 0), 1.0), shift)
    assert isinstance(grid, sn.Grid)
    np.testing.assert_array_equal(grid.origin, (5, 5, 5))
    np.savez(tmp_path / "grid.npz", values=values, origin=np.zeros(3), spacing=1.0)
    fixed = sn.Grid.load(tmp_path / "grid.npz")
    assert pose_of(fixed) is None
    with pytest.raises(InputError, match="cannot be moved"):
        move_obstacle(fixed, shift)


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_obstacle_is_of_its_kind_and_its_sizes_can_be_set(kind: str) -> None:
    obstacle = make_obstacle(kind, np.array([1.0, 2.0, 3.0]), 0.5)
    assert obstacle.kind == kind
    for label, value in sizes_of(obstacle).items():
        other = resize_obstacle(obstacle, **{label.replace(" ", "_"): 2.0 * value})
        assert sizes_of(other) == pytest.approx(sizes_of(obstacle) | {label: 2.0 * value})
        before, after = pose_of(obstacle), pose_of(other)
        assert before is not None
        assert after is not None
        np.testing.assert_allclose(after, before, atol=1e-12)
