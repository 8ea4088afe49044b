"""Arrays of goals: checked as a target is, and refused with the number of the bad row."""

import pickle
from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sinuous.poses import rotation_matrix
from sinuous.problem.target import Goals, Target
from tests.helpers import refused, refused_each

RNG = np.random.default_rng(3)
P, D, R = RNG.normal(size=(20, 3)), RNG.normal(size=(20, 3)), Rotation.random(20, rng=4)


@pytest.mark.parametrize(
    "given",
    [
        {"positions": P},
        {"directions": D},
        {"positions": P, "directions": D},
        {"positions": P, "rotations": R},
        {"positions": P, "rotations": R.as_matrix()},
        {"positions": P, "rotations": R.as_quat(scalar_first=True)},
        {"positions": P, "xyzw": R.as_quat()},
        {"positions": P, "rotations": R.as_matrix().astype(np.float32)},
    ],
    ids="+".join,
)
def test_rows_are_those_of_targets(given: dict[str, Any]) -> None:
    goals = Goals.read(given)
    names = {"positions": "position", "directions": "direction", "rotations": "rotation", "xyzw": "xyzw"}
    for i in range(20):
        single = Target(**{names[key]: value[i] for key, value in given.items()})
        np.testing.assert_array_equal(goals.rows[i], single.table[0])
        np.testing.assert_array_equal(goals[i : i + 1].rows, single.table)
    numbers = np.array([7, 3, 3])
    np.testing.assert_array_equal(goals[numbers].rows, goals.rows[numbers])
    again = pickle.loads(pickle.dumps(goals))
    np.testing.assert_array_equal(again.rows, goals.rows)
    for part in (goals.positions, goals.directions, again.positions, again.rotations):
        assert part is None or not part.flags.writeable
    assert goals.rows.flags.writeable
    assert goals.rows.flags.c_contiguous


def test_what_is_given_may_change_afterwards() -> None:
    own = P.copy()
    goals = Goals.read({"positions": own})
    own[:] = 0.0
    assert goals.positions is not None
    np.testing.assert_array_equal(goals.positions, P)


def test_loose_rotations_are_made_exact_one_like_many() -> None:
    loose = R.as_matrix() + 1e-8 * RNG.normal(size=(20, 3, 3))
    many = Goals.read({"rotations": loose}).rotations
    assert many is not None
    for matrix, exact in zip(loose, many, strict=True):
        np.testing.assert_array_equal(exact, rotation_matrix("rotation", matrix))
        np.testing.assert_allclose(exact @ exact.T, np.eye(3), atol=1e-15)


def test_the_bad_row_is_named() -> None:
    bad = P.copy()
    bad[17, 1] = np.nan
    refused("positions[17]", lambda: Goals.read({"positions": bad}), "3 finite numbers", "nan")
    refused("directions[17]", lambda: Goals.read({"directions": bad}), "3 finite numbers")
    refused("directions[4]", lambda: Goals.read({"directions": np.where(np.arange(20)[:, None] == 4, 0.0, D)}), "zero")
    mirrored = R.as_matrix()
    mirrored[5] *= -1.0
    refused("rotations[5]", lambda: Goals.read({"rotations": mirrored}), "determinant 1")
    mirrored[2, 0, 0] = np.inf
    refused("rotations[2]", lambda: Goals.read({"rotations": mirrored}), "rows of 3 finite numbers")
    quaternions = R.as_quat()
    quaternions[9] = 0.0
    refused("xyzw[9]", lambda: Goals.read({"xyzw": quaternions}), "not zero")
    refused("rotations[9]", lambda: Goals.read({"rotations": quaternions}), "not zero")


def test_what_does_not_fit_together_is_refused() -> None:
    refused("positions", partial(Goals.read, {}), "nothing is asked")
    refused("directions", lambda: Goals.read({"positions": P, "directions": D[:4]}), "positions: 20", "got 4")
    refused("rotations", lambda: Goals.read({"positions": P, "rotations": R[:4]}), "positions: 20", "got 4")
    refused("xyzw", lambda: Goals.read({"positions": P[:4], "xyzw": R.as_quat()}), "positions: 4", "got 20")
    refused("directions", lambda: Goals.read({"positions": P, "directions": D, "rotations": R}), "one of directions")
    refused("xyzw", lambda: Goals.read({"rotations": R, "xyzw": R.as_quat()}), "one of rotations, xyzw")
    shapes = (5, "a", [[1, 2]], P.T, P[0], P[None], [[1, 2, True]], [[1, 2, 3], [1, 2]], True)
    refused_each("positions", shapes, lambda value: Goals.read({"positions": value}), "rows of 3 finite numbers")
    refused_each("xyzw", (True, P, R.as_matrix()), lambda value: Goals.read({"xyzw": value}), "rows of 4")
    refused_each("rotations", (True, P[0], 3), lambda value: Goals.read({"rotations": value}), "quaternions")


def test_there_may_be_none() -> None:
    assert len(Goals.read({"positions": np.empty((0, 3))})) == 0
    assert Goals.read({"directions": np.empty((0, 3)), "positions": np.empty((0, 3))}).rows.shape == (0, 15)
    assert len(Goals.read({"rotations": np.empty((0, 3, 3))})) == 0
