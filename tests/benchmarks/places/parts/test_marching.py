"""Marching cubes about a line alone: the whole surface, and nothing else."""

import math

import numpy as np
import pytest
import trimesh

from benchmarks.places.parts.marching import around
from sinuous.base.checks import Floats

LINE = np.linspace([0.3, -0.2, 0.5], [0.3, 2.8, 0.5], 60)
"""Of length 3."""

WIDE = 0.47
"""Radius about it: no corner of a cell lies right on the surface."""


def to_line(points: Floats) -> Floats:
    return np.asarray(np.linalg.norm(points[:, None] - LINE, axis=-1).min(axis=1))


def test_the_surface_about_a_line_is_a_capsule() -> None:
    surface = around(LINE, WIDE, 0.1, lambda points: to_line(points) - WIDE)
    solid = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    assert solid.is_watertight
    assert solid.volume == pytest.approx(math.pi * WIDE**2 * 3.0 + 4.0 / 3.0 * math.pi * WIDE**3, rel=0.03)
    assert np.abs(to_line(surface.vertices) - WIDE).max() < 0.02


def test_what_is_taken_away_opens_it() -> None:
    def pipe(points: Floats) -> Floats:
        hollow = np.hypot(points[:, 0] - 0.3, points[:, 2] - 0.5)
        return np.maximum(to_line(points) - WIDE, 0.31 - hollow)

    surface = around(LINE, WIDE, 0.1, pipe)
    solid = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    assert solid.is_watertight
    assert solid.euler_number == 0
