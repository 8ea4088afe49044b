"""Voxels hold all that may be reached; directions are spread evenly."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.workspace.grid import Voxels, directions_of, reach_of
from tests.workspace.maps import ROBOT


def test_a_voxel_is_about_the_base_and_all_hold_the_reach() -> None:
    robot = ROBOT.changed(base=sn.pose((3, -4, 5)), tool=sn.pose((0, 0, 7)))
    voxels = Voxels.about(robot, 10.0, None, None)
    assert reach_of(robot) == 127.0
    assert voxels.shape == (25, 25, 25)
    np.testing.assert_allclose(voxels.middles[12, 12, 12], (3, -4, 5))
    assert Voxels.about(robot, None, None, None).shape == (71, 71, 71)


def test_corners_make_a_slice() -> None:
    voxels = Voxels.about(ROBOT, 10.0, (-30, 0, 0), (30, 0, 50))
    assert voxels.shape == (7, 1, 6)


@pytest.mark.parametrize("count", [1, 6, 26, 100])
def test_directions_are_unit_vectors_all_round(count: int) -> None:
    axes = directions_of(count)
    np.testing.assert_allclose(np.linalg.norm(axes, axis=1), 1.0)
    assert axes.shape == (count, 3)
    assert len(np.unique(axes.round(9), axis=0)) == count
    if count > 1:
        assert np.linalg.norm(axes.mean(axis=0)) < 0.2
