"""What turns one orientation into another: it does, by the least angle, also where two directions are opposite."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sinuous.solution.turns import turn_between
from tests.helpers import Floats


def directions(seed: int) -> tuple[Floats, Floats]:
    pair = np.random.default_rng(seed).normal(size=(2, 3))
    one, other = pair / np.linalg.norm(pair, axis=1, keepdims=True)
    return one, other


@pytest.mark.parametrize("seed", range(10))
def test_a_direction_is_turned_into_another(seed: int) -> None:
    one, other = directions(seed)
    turn = turn_between(one, other)
    np.testing.assert_allclose(Rotation.from_rotvec(turn).apply(one), other, atol=1e-12)
    assert np.linalg.norm(turn) == pytest.approx(math.acos(one @ other))
    assert turn @ one == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_a_rotation_is_turned_into_another(seed: int) -> None:
    one, other = Rotation.random(2, rng=np.random.default_rng(seed)).as_matrix()
    np.testing.assert_allclose(Rotation.from_rotvec(turn_between(one, other)).as_matrix() @ one, other, atol=1e-12)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("off", [0.0, 1e-15, 1e-10, 1e-7])
def test_opposite_directions_are_half_a_turn_apart(seed: int, off: float) -> None:
    one, across = directions(seed)
    other = -one + off * np.cross(one, across)
    turn = turn_between(one, other / np.linalg.norm(other))
    assert np.linalg.norm(turn) == pytest.approx(math.pi, abs=2.0 * off + 1e-12)
    np.testing.assert_allclose(Rotation.from_rotvec(turn).apply(one), other, atol=2e-9)


@pytest.mark.parametrize("off", [0.0, 1e-15, 1e-12, 1e-8])
def test_near_directions_are_little_apart(off: float) -> None:
    np.testing.assert_allclose(
        turn_between(np.array([0.0, 0.0, 1.0]), np.array([off, 0.0, 1.0])), [0.0, off, 0.0], rtol=1e-9, atol=1e-24
    )
