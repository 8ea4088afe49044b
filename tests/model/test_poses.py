"""Poses: rotations are exact, stated one way, by SciPy's conventions."""

import math
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sinuous.base.checks import direction as unit
from sinuous.model.poses import as_pose, least_rotation, pose, rotation_matrix
from sinuous.problem.target import Target
from sinuous.scene.obstacles import Box, Placement
from tests.helpers import NOT_VECTORS, Floats, random_rotation, refused, refused_each, with_each

coordinates = st.one_of(st.floats(-1.0, 1.0), st.sampled_from([0.0, 1e-8, -1e-16, 1e-100, -1e-200, 5e-324, 1.0, -1.0]))
directions = st.tuples(coordinates, coordinates, coordinates).filter(any).map(lambda v: unit("direction", v))


def is_rotation(matrix: Floats, tolerance: float = 1e-15) -> bool:
    close = np.abs(matrix @ matrix.T - np.eye(3)).max() <= 4 * tolerance
    return bool(close and np.linalg.det(matrix) > 0.0)


@given(directions)
def test_least_rotation_takes_z_there_the_shortest_way(direction: Floats) -> None:
    rotation = least_rotation(direction)
    assert is_rotation(rotation)
    np.testing.assert_allclose(rotation[:, 2], direction, atol=1e-15)
    assert np.trace(rotation) == pytest.approx(1.0 + 2.0 * direction[2], abs=1e-15)  # the angle is no more than needed


@pytest.mark.parametrize("tiny", [1e-7, 1e-12, 1e-20, 1e-100])
def test_nearly_down_is_turned_about_the_axis_across(tiny: float) -> None:
    rotation = least_rotation(unit("direction", [0.0, tiny, -1.0]))
    assert is_rotation(rotation)
    np.testing.assert_allclose(rotation, np.diag([1.0, -1.0, -1.0]), atol=2 * tiny)
    rotation = least_rotation(unit("direction", [tiny, 0.0, -1.0]))
    np.testing.assert_allclose(rotation, np.diag([-1.0, 1.0, -1.0]), atol=2 * tiny)


@with_each("seed", range(5))
@with_each("scale", [1.0, -3.0, 1e-200, 1e200])
def test_quaternions_are_wxyz_of_any_length(seed: int, scale: float) -> None:
    expected = Rotation.from_matrix(random_rotation(np.random.default_rng(seed)))
    x, y, z, w = expected.as_quat()
    got = rotation_matrix("rotation", (scale * w, scale * x, scale * y, scale * z))
    np.testing.assert_allclose(got, expected.as_matrix(), atol=1e-15)


@with_each("seed", range(5))
def test_a_rotation_may_be_stated_in_other_ways(seed: int) -> None:
    expected = Rotation.from_matrix(random_rotation(np.random.default_rng(seed)))
    ways: list[dict[str, Any]] = [{"rotation": expected}, {"xyzw": 3.0 * expected.as_quat()}]
    for way in ways:
        np.testing.assert_allclose(pose(**way)[:3, :3], expected.as_matrix(), atol=1e-15)
        np.testing.assert_allclose(np.array(Target(**way).rotation), expected.as_matrix(), atol=1e-15)
        np.testing.assert_allclose(Box((0, 0, 0), (1, 1, 1), **way).rotation, expected.as_matrix(), atol=1e-15)
        moved = Placement(2.0, **way).apply(np.array([[1.0, 2.0, 3.0]]))
        np.testing.assert_allclose(moved, [expected.apply([2.0, 4.0, 6.0])], atol=1e-14)


@pytest.mark.parametrize("make", [pose, Target, partial(Box, (0, 0, 0), (1, 1, 1)), partial(Placement, 1.0)])
def test_an_orientation_is_stated_once(make: Any) -> None:
    refused("xyzw", lambda: make(rotation=np.eye(3), xyzw=(0, 0, 0, 1)), "rotation, xyzw")
    refused_each("xyzw", ((0, 0, 1), (0, 0, 0, 0), np.eye(3), "up"), lambda value: make(xyzw=value))
    refused("rotation", lambda: make(rotation=Rotation.identity(3)), "3x3")


@given(st.integers(0, 10**6))
def test_what_is_exact_is_kept(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for matrix in (least_rotation(unit("direction", rng.normal(size=3))), pose(rotation=rng.normal(size=4))[:3, :3]):
        np.testing.assert_array_equal(rotation_matrix("rotation", matrix), matrix)
    once = rotation_matrix("rotation", np.round(random_rotation(rng), 7))
    np.testing.assert_array_equal(rotation_matrix("rotation", once), once)
    direction = unit("direction", rng.normal(size=3) * rng.choice([1e-9, 1.0, 1e9]))
    np.testing.assert_array_equal(unit("direction", direction), direction)


def test_rounded_matrices_are_made_exact() -> None:
    exact = random_rotation(np.random.default_rng(1))
    got = rotation_matrix("rotation", np.round(exact, 7))
    assert is_rotation(got)
    np.testing.assert_allclose(got, exact, atol=2e-7)
    assert not got.flags.writeable


@with_each(
    "value",
    [
        np.zeros((3, 3)),
        2.0 * np.eye(3),
        np.diag([1.0, 1.0, -1.0]),
        np.eye(3) + 1e-4,
        np.full((3, 3), 1e200),
        [[1e200, -1e200, 0.0], [1e200, 1e200, 0.0], [0.0, 0.0, 1.0]],
        np.eye(4),
        np.full((3, 3), math.nan),
        (0.0, 0.0, 0.0, 0.0),
        (math.inf, 0.0, 0.0, 0.0),
        (1.0, 0.0, 0.0),
        (True, False, False, False),
        [[True, False, False], [False, True, False], [False, False, True]],
        [[1, 0, 0], [0, 1], [0, 0, 1]],
        "identity",
        None,
        1.0,
        {},
    ],
)
def test_what_is_no_rotation_is_refused(value: Any) -> None:
    refused("rotation", lambda: rotation_matrix("rotation", value))


def test_a_pose_is_what_was_said() -> None:
    rng = np.random.default_rng(2)
    rotation, position = random_rotation(rng), rng.normal(size=3)
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = rotation, position
    for got in (pose(position, rotation=rotation), pose(matrix=whole)):
        np.testing.assert_allclose(got, whole, atol=1e-15)
        assert not got.flags.writeable
    np.testing.assert_array_equal(pose(), np.eye(4))
    np.testing.assert_array_equal(pose((1, 2, 3))[:3, 3], [1, 2, 3])
    np.testing.assert_allclose(pose(direction=(0, 5, 0))[:3, 2], [0, 1, 0])


def test_a_pose_is_said_one_way() -> None:
    refused("rotation", lambda: pose(direction=(0, 0, 1), rotation=np.eye(3)))
    refused("matrix", lambda: pose(direction=(0, 0, 1), matrix=np.eye(4)))
    refused("matrix", lambda: pose(rotation=np.eye(3), matrix=np.eye(4)))
    refused("position", lambda: pose((1, 2, 3), matrix=np.eye(4)))


@with_each("value", [v for v in NOT_VECTORS if v is not None])
def test_bad_positions_and_directions_are_refused(value: Any) -> None:
    refused("position", lambda: pose(value))
    refused("direction", lambda: pose(direction=value))


@with_each("value", [np.eye(3), np.zeros((4, 4)), np.diag([1.0, 1.0, 1.0, 2.0]), np.eye(4) * math.nan, "eye"])
def test_what_is_no_matrix_of_a_pose_is_refused(value: Any) -> None:
    refused("matrix", lambda: pose(matrix=value))
    refused("base.matrix", lambda: as_pose("base", value))
