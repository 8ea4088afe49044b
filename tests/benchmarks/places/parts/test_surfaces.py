"""Surfaces are closed, turned outwards, and as far from their curve as they should be."""

import math

import numpy as np
import pytest
import trimesh

from benchmarks.places.parts.shapes import arc
from benchmarks.places.parts.surfaces import Surface, blind_bore, joined, loft, open_tube, plate, tube, widening_tube
from sinuous.base.checks import Floats


def as_trimesh(surface: Surface) -> trimesh.Trimesh:
    return trimesh.Trimesh(surface.vertices, surface.faces, process=False)


def curve() -> Floats:
    return arc(np.eye(4), np.array([1.0, 1.0, 2.0]), 40)


def test_a_tube_is_closed_and_has_the_volume_of_one() -> None:
    solid = as_trimesh(tube(curve(), 0.3, sides=40, caps=20))
    assert solid.is_watertight
    assert solid.volume == pytest.approx(math.pi * 0.3**2 * 2.0 + 4.0 / 3.0 * math.pi * 0.3**3, rel=0.02)


def test_a_tube_cuts_nothing_off() -> None:
    """The sides of the polygon are at the radius, not its corners; inside of the bend, steps cut off a little."""
    poses = curve()
    surface = tube(poses, 0.3)
    middles = surface.vertices[surface.faces].mean(axis=1)
    gaps = np.linalg.norm(middles[:, None] - poses[:, :3, 3], axis=-1).min(axis=1)
    assert 0.295 < gaps.min() < gaps.max() < 0.31


def test_what_is_turned_is_a_hollow() -> None:
    wall = as_trimesh(joined([tube(curve(), 0.4), tube(curve(), 0.3).turned]))
    assert wall.is_watertight
    assert wall.volume == pytest.approx(
        as_trimesh(tube(curve(), 0.4)).volume - as_trimesh(tube(curve(), 0.3)).volume, rel=1e-9
    )


@pytest.mark.parametrize("bottom", [False, True])
def test_an_open_tube_is_a_wall_with_a_mouth(bottom: bool) -> None:
    poses = arc(np.eye(4), np.array([0.0, 0.0, 2.0]), 10)
    solid = as_trimesh(open_tube(poses, 0.3, 0.4, bottom, sides=80))
    assert solid.is_watertight
    assert solid.euler_number == (2 if bottom else 0)
    floor = math.pi * 0.4**2 * 0.1 if bottom else 0.0
    assert solid.volume == pytest.approx(math.pi * (0.4**2 - 0.3**2) * 2.0 + floor, rel=0.01)


def test_a_blind_bore_has_one_mouth() -> None:
    solid = as_trimesh(blind_bore(curve()[20], 0.3, 2.0, 1.0, 0.5, sides=80))
    assert solid.is_watertight
    assert solid.euler_number == 2
    assert solid.volume == pytest.approx(4.0 * 2.5 - math.pi * 0.3**2 * 2.0, rel=0.01)


def test_a_plate_has_a_hole() -> None:
    solid = as_trimesh(plate(curve()[20], 1.0, 0.4, 0.1, sides=48))
    assert solid.is_watertight
    assert solid.euler_number == 0
    assert solid.volume == pytest.approx(0.1 * (4.0 - math.pi * 0.4**2), rel=0.01)


def test_a_loft_over_squares_is_a_box() -> None:
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    solid = as_trimesh(loft(np.stack([square, square + np.array([0, 0, 3])]), np.array([[0, 0, 0], [0, 0, 3.0]])))
    assert solid.is_watertight
    assert solid.volume == pytest.approx(12.0)


def test_a_widening_tube_is_as_wide_as_is_said_all_along() -> None:
    poses, share = curve(), np.linspace(0.0, 1.0, 41)
    inside, outside = 0.3 - 0.1 * share, 0.4 - 0.1 * share
    wall = as_trimesh(widening_tube(poses, inside, outside, sides=40))
    assert wall.is_watertight
    sections = math.pi * (outside**2 - inside**2)
    assert wall.volume == pytest.approx(2.0 * sections.mean(), rel=0.02)
    gaps = np.linalg.norm(wall.vertices[:, None] - poses[:, :3, 3], axis=-1)
    nearest = gaps.argmin(axis=1)
    assert (gaps.min(axis=1) >= 0.97 * inside[nearest]).all()
