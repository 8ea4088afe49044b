"""Targets: what is asked, in the form that the kernels read, and bad input.

Tolerances, preferences and problems refuse what they cannot mean.
"""

import math
import pickle
from typing import Any

import numpy as np
import pytest
from numba import typeof
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.kernels.tables import DIRECTION, FREE, ROTATION
from sinuous.model.poses import rotation_matrix
from sinuous.problem.target import TipGoals, target_list, target_table
from tests.helpers import NOT_VECTORS, present, random_rotation, refused, refused_each, with_each
from tests.scene.shapes import cube

ROBOT = sn.Robot.uniform(3, 1.0)


def test_a_target_is_what_was_said() -> None:
    target = sn.Target((1, 2, 3), direction=(0, 0, -2))
    np.testing.assert_array_equal(target.position, [1.0, 2.0, 3.0])
    np.testing.assert_array_equal(target.direction, [0.0, 0.0, -1.0])
    assert target.rotation is None
    assert target.segment is None
    np.testing.assert_array_equal(target.table, [[-1, 1, 1, 2, 3, DIRECTION, 0, 0, -1, 0, 0, 0, 0, 0, 0]])
    assert repr(target) == "Target(position=(1, 2, 3), direction=(0, 0, -1))"
    assert repr(sn.Target(np.eye(4))) == "Target(position=(0, 0, 0), rotation=(1, 0, 0, 0))"


def test_rows_of_every_kind() -> None:
    np.testing.assert_array_equal(sn.Target((1, 2, 3), segment=2).table, [[1, 1, 1, 2, 3, FREE, *[0] * 9]])
    rotation = random_rotation(np.random.default_rng(0))
    row = sn.Target(rotation=rotation).table
    np.testing.assert_array_equal(row[0, :6], [-1, 0, 0, 0, 0, ROTATION])
    np.testing.assert_allclose(row[0, 6:], rotation.ravel(), atol=1e-15)
    half_turn = sn.Target(rotation=(0, 0, 0, 1))  # a quaternion wxyz: half a turn about z
    np.testing.assert_allclose(present(half_turn.rotation), np.diag([-1.0, -1.0, 1.0]), atol=1e-15)
    assert repr(sn.Target(direction=(1, 0, 0), segment=2)) == "Target(direction=(1, 0, 0), segment=2)"


@with_each("value", [v for v in NOT_VECTORS if v is not None])
def test_bad_vectors_are_refused(value: Any) -> None:
    refused("position", lambda: sn.Target(value))
    refused("direction", lambda: sn.Target(direction=value))


def test_bad_orientations_are_refused() -> None:
    refused("direction", lambda: sn.Target(direction=(0, 0, 0)), "not zero")
    bad = (np.zeros((3, 3)), np.diag([1, 1, -1]), (0, 0, 0, 0), np.eye(4), np.full((3, 3), math.nan))
    refused_each("rotation", bad, lambda rotation: sn.Target(rotation=rotation))


def test_lists_of_targets() -> None:
    a, b = sn.Target((0, 0, 1)), sn.Target((0, 0, 2), segment=1)
    assert target_list("targets", a) == (a,)
    assert target_list("targets", [a, b]) == (a, b)
    assert target_list("targets", iter([a, b])) == (a, b)
    np.testing.assert_array_equal(target_table(ROBOT, (a,)), a.table)
    np.testing.assert_array_equal(target_table(ROBOT, (a, b)), np.concatenate([a.table, b.table]))


ROWS = np.random.default_rng(5).normal(size=(200, 10)) * 10.0 ** np.random.default_rng(6).integers(-9, 9, (200, 1))
ROTATIONS = Rotation.random(20, rng=7)
UNITS = np.concatenate([ROTATIONS.as_matrix()[:, 0], np.eye(3), ROWS[:20, 3:6]])
"""Unit vectors, up to rounding, which are kept; and others."""


@pytest.mark.parametrize(
    "columns",
    [
        {"position": ROWS[:, :3]},
        {"direction": ROWS[:, 3:6]},
        {"position": ROWS[:, :3], "direction": ROWS[:, 3:6]},
        {"position": ROWS[:, :3], "rotation": ROWS[:, 6:]},
        {"rotation": ROWS[:, 6:].tolist()},
        {"position": ROWS[:, :3], "xyzw": ROWS[:, 6:]},
        {"direction": UNITS},
        {"xyzw": ROTATIONS.as_quat()},
        {"rotation": ROTATIONS},
        {"rotation": np.stack([random_rotation(np.random.default_rng(i)) for i in range(3)])},
    ],
    ids=lambda columns: "+".join(columns) + type(next(iter(columns.values()))).__name__,
)
def test_many_targets_are_those_made_one_by_one(columns: dict[str, Any]) -> None:
    """To the last bit, and as frozen; kernels get tables that they may be called with."""
    targets = sn.Target.each(**columns)
    singles = [sn.Target(**dict(zip(columns, row, strict=True))) for row in zip(*columns.values(), strict=True)]
    assert len(targets) == len(singles)
    for target, single in zip(targets, singles, strict=True):
        for key in ("position", "direction", "rotation"):
            np.testing.assert_array_equal(getattr(target, key), getattr(single, key))
            assert getattr(target, key) is None or not getattr(target, key).flags.writeable
        assert target.segment is None
        assert target._table.tobytes() == single._table.tobytes()
        assert typeof(target._table) == typeof(single._table)  # type: ignore[no-untyped-call]
        assert repr(target) == repr(single)
    with pytest.raises(AttributeError):
        targets[0].segment = 2  # type: ignore[misc]
    again = pickle.loads(pickle.dumps(targets[-1]))
    np.testing.assert_array_equal(again.table, targets[-1].table)


def test_wrong_rows_of_many_targets_are_refused() -> None:
    good = np.ones((3, 3))
    refused("position", sn.Target.each, "position, direction or rotation")
    refused("direction", lambda: sn.Target.each(good, direction=good, rotation=np.ones((3, 4))), "rotation")
    refused("xyzw", lambda: sn.Target.each(rotation=np.ones((3, 4)), xyzw=np.ones((3, 4))), "one of rotation, xyzw")
    refused("xyzw", lambda: sn.Target.each(good, xyzw=np.ones((2, 4))), "as many as there are positions")
    refused("direction", lambda: sn.Target.each(good, direction=good[:2]), "as many as there are positions")
    refused("direction[1]", lambda: sn.Target.each(direction=[[1, 0, 0], [0, 0, 0]]), "not zero")
    refused("rotation[0]", lambda: sn.Target.each(rotation=[np.diag([1, 1, -1])]))
    refused_each("position", (5, "a", [[1, 2]], [1, 2, 3], [[1, 2, True]]), sn.Target.each)
    refused("position[1]", lambda: sn.Target.each([[1, 2, 3], [1, 2, math.inf]]), "3 finite numbers")
    refused_each("rotation", (5, "a", [[1, 2]], [1, 0, 0, 0], [[1, 0, 0], [1]]), lambda r: sn.Target.each(rotation=r))


def test_what_is_no_list_of_targets_is_refused() -> None:
    refused_each(
        "targets", (None, 3, "abc", {"position": (0, 0, 1)}), lambda value: target_list("targets", value), "a Target"
    )
    refused("len(targets)", lambda: target_list("targets", []))
    refused("len(targets)", lambda: target_list("targets", [sn.Target((0, 0, 1))] * 1001))
    refused("targets[1]", lambda: target_list("targets", [sn.Target((0, 0, 1)), (0, 0, 1)]))


def test_a_segment_that_the_robot_lacks_is_refused() -> None:
    targets = (sn.Target((0, 0, 1)), sn.Target((0, 0, 1), segment=4))
    refused("targets[1].segment", lambda: target_table(ROBOT, targets), "1 to 3")
    target_table(ROBOT, (sn.Target((0, 0, 1), segment=3),))


RNG = np.random.default_rng(3)
P, D, R = RNG.normal(size=(20, 3)), RNG.normal(size=(20, 3)), Rotation.random(20, rng=4)


def test_loose_rotations_are_made_exact_one_like_many() -> None:
    loose = R.as_matrix() + 1e-8 * RNG.normal(size=(20, 3, 3))
    many = present(TipGoals.read({"rotations": loose}).rotations)
    for matrix, exact in zip(loose, many, strict=True):
        np.testing.assert_array_equal(exact, rotation_matrix("rotation", matrix))
        np.testing.assert_allclose(exact @ exact.T, np.eye(3), atol=1e-15)


def test_the_bad_row_is_named() -> None:
    bad = P.copy()
    bad[17, 1] = np.nan
    refused("positions[17]", lambda: TipGoals.read({"positions": bad}), "3 finite numbers", "nan")
    refused("directions[17]", lambda: TipGoals.read({"directions": bad}), "3 finite numbers")
    refused(
        "directions[4]", lambda: TipGoals.read({"directions": np.where(np.arange(20)[:, None] == 4, 0.0, D)}), "zero"
    )
    mirrored = R.as_matrix()
    mirrored[5] *= -1.0
    refused("rotations[5]", lambda: TipGoals.read({"rotations": mirrored}), "determinant 1")
    mirrored[2, 0, 0] = np.inf
    refused("rotations[2]", lambda: TipGoals.read({"rotations": mirrored}), "rows of 3 finite numbers")
    quaternions = R.as_quat()
    quaternions[9] = 0.0
    refused("xyzw[9]", lambda: TipGoals.read({"xyzw": quaternions}), "not zero")
    refused("rotations[9]", lambda: TipGoals.read({"rotations": quaternions}), "not zero")


FIVE = sn.Robot.uniform(5, (45, 70))


@with_each("value", [0, -1, float("nan"), float("inf"), "1", True, None])
def test_wrong_tolerances_are_refused(value: Any) -> None:
    refused("angle", lambda: sn.Tolerance(angle=value))


@pytest.mark.parametrize("key", ["start", "bends", "clearance"])
def test_wrong_preferences_are_refused(key: str) -> None:
    refused_each(key, (-1, float("nan"), "much"), lambda value: sn.Preferences(**{key: value}))
    assert sn.Preferences(**{key: 1})
    assert not sn.Preferences()


@pytest.mark.parametrize("size", [0.01, 1e6])
def test_a_mesh_in_another_unit_is_refused(size: float) -> None:
    scene = [sn.Sphere((0, 0, 0), 1), sn.Mesh(*cube(size))]
    refused("scene[1].mesh.vertices", lambda: sn.Problem(FIVE, sn.Target((0, 0, 9)), scene), "287.5 long")
    assert len(sn.Problem(FIVE, sn.Target((0, 0, 9)), [sn.Mesh(*cube(50.0))]).scene) == 1
