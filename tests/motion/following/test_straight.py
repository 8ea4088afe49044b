"""The straight way of the tip between waypoints."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.checks import Floats
from sinuous.motion.following.straight import Straight, tip_acceleration

ROBOT = sn.Robot.uniform(4, (0.7, 1.3), max_bend=3.0)


def random_configuration(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    q: Floats = np.concatenate([rng.uniform(-2.0, 2.0, (4, 2)), rng.uniform(0.7, 1.3, (4, 1))], axis=-1)
    return q


@given(st.integers(0, 10_000), st.floats(1e-4, 1.0))
def test_the_bound_of_the_acceleration_holds(seed: int, share: float) -> None:
    """Second differences of the tip's way, along all of it."""
    q0 = random_configuration(seed)
    q1 = q0 + share * (random_configuration(seed + 1) - q0)
    t = np.linspace(0.0, 1.0, 101)[:, None, None]
    tips = ROBOT.tip((1.0 - t) * q0 + t * q1)[:, :3, 3]
    measured = np.linalg.norm(np.diff(tips, 2, axis=0), axis=-1).max() * 100.0**2
    assert measured <= tip_acceleration(q0.tolist(), q1.tolist()) * (1.0 + 1e-6) + 1e-7


@given(st.integers(0, 10_000), st.floats(1e-4, 0.3))
def test_the_bound_of_the_deviation_holds(seed: int, share: float) -> None:
    q0 = random_configuration(seed)
    q1 = q0 + share * (random_configuration(seed + 1) - q0)
    a, b = (sn.Target(ROBOT.tip(q)[:3, 3]) for q in (q0, q1))
    t = np.linspace(0.0, 1.0, 101)[:, None, None]
    tips = ROBOT.tip((1.0 - t) * q0 + t * q1)[:, :3, 3]
    line = tips[-1] - tips[0]
    along = np.clip((tips - tips[0]) @ line / (line @ line), 0.0, 1.0)
    measured = np.linalg.norm(tips - tips[0] - along[:, None] * line, axis=-1).max()
    for enough in (0.0, 0.01, 10.0):
        assert measured <= Straight(a, b).deviation(ROBOT, (q0, q1), (0.0, 1.0), enough) + 1e-9


def test_no_motion_has_no_deviation() -> None:
    q = random_configuration(0)
    here = sn.Target(ROBOT.tip(q)[:3, 3])
    assert Straight(here, here).deviation(ROBOT, (q, q), (0.0, 1.0), 0.0) == pytest.approx(0.0, abs=1e-12)


def asked(target: sn.Target) -> tuple[Floats, Floats, Floats]:
    """Position, direction and rotation of a target; zeros where it asks for none."""
    parts = (target.position, target.direction, target.rotation)
    position, direction, rotation = (np.zeros(3) if part is None else part for part in parts)
    return position, direction, rotation


def test_orientations_go_the_shorter_way_round() -> None:
    turn = Rotation.from_rotvec([0.0, 0.0, 1.0])
    a = sn.Target((0, 0, 3), rotation=np.eye(3))
    b = sn.Target((0, 1, 3), rotation=turn)
    position, _, rotation = asked(Straight(a, b).at(0.25))
    np.testing.assert_allclose(position, [0.0, 0.25, 3.0])
    np.testing.assert_allclose(rotation, Rotation.from_rotvec([0.0, 0.0, 0.25]).as_matrix(), atol=1e-12)
    a, b = sn.Target((0, 0, 3), direction=(1, 0, 0)), sn.Target((0, 0, 3), direction=(0, 1, 0))
    np.testing.assert_allclose(asked(Straight(a, b).at(0.5))[1], [0.5**0.5, 0.5**0.5, 0.0], atol=1e-12)
    opposite = Straight(a, sn.Target((0, 0, 3), direction=(-1, 0, 0)))
    assert asked(opposite.at(0.5))[1] @ [1.0, 0.0, 0.0] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(asked(opposite.at(1.0))[1], [-1.0, 0.0, 0.0], atol=1e-12)
    same = Straight(a, sn.Target((0, 0, 2), direction=(1, 0, 0)))
    np.testing.assert_allclose(asked(same.at(0.3))[1], [1.0, 0.0, 0.0])


def test_there_is_one_where_the_same_is_asked_of_the_tip() -> None:
    place, turned = sn.Target((0, 0, 3)), sn.Target((0, 1, 3), direction=(0, 0, 1))
    elbow, direction = sn.Target((0, 0, 1), segment=1), sn.Target(direction=(0, 0, 1))
    assert Straight.between((place,), (place,)) is not None
    assert Straight.between((turned,), (turned,)) is not None
    pairs = [
        ((place,), (turned,)),
        ((elbow,), (elbow,)),
        ((direction,), (direction,)),
        ((place, elbow), (place, elbow)),
    ]
    assert all(Straight.between(begin, end) is None for begin, end in pairs)
    assert Straight.between(None, (place,)) is None
