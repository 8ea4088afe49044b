"""Scans lie on the surfaces, and nothing as thick as the body passes between their points."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from benchmarks.places import make, scans
from benchmarks.places.around.spheres import spheres
from benchmarks.places.families import _DRAWN
from benchmarks.places.place import Sketch
from benchmarks.places.scans import scan, triangles
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.point_cloud import PointCloud


def on_surface(corners: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Points even over triangles."""
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=-1)
    which = rng.choice(len(corners), count, p=areas / areas.sum())
    a, b = np.sort(rng.random((2, count)), axis=0)
    weights = np.stack([a, b - a, 1.0 - b], axis=-1)
    points: Floats = np.einsum("mc,mcx->mx", weights, corners[which])
    return points


@pytest.mark.parametrize("family", ["pipe 1.6", "shelf", "drum"])
def test_scans_have_no_gaps(family: str) -> None:
    rng = np.random.default_rng(0)
    sketch, scanned = scanned_and_not(family)
    (cloud,) = scanned.obstacles
    assert isinstance(cloud, PointCloud)
    radius = min(sketch.robot.radii)
    corners = np.concatenate([triangles(obstacle) for obstacle in sketch.obstacles])
    places = on_surface(corners, 60_000, rng)
    gaps = np.asarray(cKDTree(cloud.points).query(places)[0])
    assert gaps.max() < radius + cloud.radii.min()
    assert np.asarray(cKDTree(places).query(cloud.points)[0]).max() < radius  # and points lie nowhere else


def scanned_and_not(family: str) -> tuple[Sketch, Sketch]:
    draw = _DRAWN[family][0]
    for attempt in range(100):
        scanned = scan(draw, 2, np.random.default_rng(attempt))
        sketch = draw(2, np.random.default_rng(attempt))
        if scanned is not None and sketch is not None:
            return sketch, scanned
    raise AssertionError


def test_a_scan_is_one_cloud_of_the_same_scene() -> None:
    made = make("spheres 40 scan", 3)
    (cloud,) = made.scene.obstacles
    assert isinstance(cloud, PointCloud)
    assert len(cloud.points) > 1000


def test_a_place_that_points_would_narrow_too_much_is_drawn_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scans, "THICKNESS", 50.0)
    assert scan(lambda seed, rng: spheres(12, seed, rng), 0, np.random.default_rng(0)) is None


def test_triangles_of_exact_shapes_are_on_their_surfaces() -> None:
    box = triangles(Box((1, 2, 3), (1, 1, 2)))
    assert np.abs(box - [1, 2, 3]).max(axis=(0, 1)).tolist() == pytest.approx([0.5, 0.5, 1.0])
    ball = triangles(Sphere((1, 2, 3), 0.5))
    np.testing.assert_allclose(np.linalg.norm(ball - [1, 2, 3], axis=-1), 0.5)
