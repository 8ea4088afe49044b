"""Dots lie on what they stand for."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.obstacles import measure
from sinuous.view.display.surfaces import MOST_POINTS, Dotted, points_of
from tests.helpers import Floats

SHAPE = (15, 16, 17)
INDEX = np.moveaxis(np.indices(SHAPE), 0, -1).astype(np.float64)
ORIGIN = np.array([-0.8, -0.7, -0.6])


def ball(points: Floats) -> Floats:
    return np.asarray(np.linalg.norm(points - 0.03, axis=-1) - 0.5)


VALUES = ball(ORIGIN + 0.1 * INDEX)


@pytest.mark.parametrize("obstacle", [sn.Grid(VALUES, ORIGIN, 0.1), sn.Field(ball, ORIGIN, -ORIGIN, 0.1)])
def test_dots_of_distances_lie_where_these_are_zero(obstacle: Dotted) -> None:
    found = points_of(obstacle)
    assert len(found) > 300
    assert np.abs(ball(found)).max() < 0.005
    for axis in range(3):
        assert np.ptp(found[:, axis]) > 0.95


def test_dots_of_cells_are_those_that_can_be_seen() -> None:
    grid = sn.Grid(VALUES < 0.0, ORIGIN, 0.1)
    found = points_of(grid)
    depth = -measure(grid, found)
    assert (depth > 0.0).all()
    inner = np.zeros((5, 5, 5), bool)
    inner[1:4, 1:4, 1:4] = True
    assert len(points_of(sn.Grid(inner, (0, 0, 0), 1))) == 26
    assert len(points_of(sn.Grid(np.ones((3, 3, 3), bool), (0, 0, 0), 1))) == 26


@pytest.mark.parametrize("count", [5, MOST_POINTS, MOST_POINTS + 1, 3 * MOST_POINTS])
def test_clouds_are_thinned(count: int) -> None:
    points = np.random.default_rng(0).normal(size=(count, 3))
    found = points_of(sn.PointCloud(points, 0.1))
    assert min(count, MOST_POINTS // 2) <= len(found) <= MOST_POINTS
    assert (found[0] == points[0]).all()
