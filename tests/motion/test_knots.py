"""The straight line of the tip between waypoints."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.motion.knots import TipLine


def test_a_part_of_the_line_is_between_its_shares() -> None:
    ends = np.empty((2, 3))
    TipLine(sn.Target((1.0, 0.0, 3.0)), sn.Target((5.0, 0.0, 3.0))).draw((0.25, 1.0), ends)
    np.testing.assert_allclose(ends, [(2.0, 0.0, 3.0), (5.0, 0.0, 3.0)])


def asked(target: sn.Target) -> tuple[Floats, Floats, Floats]:
    """Position, direction and rotation of a target; zeros where it asks for none."""
    parts = (target.position, target.direction, target.rotation)
    position, direction, rotation = (np.zeros(3) if part is None else part for part in parts)
    return position, direction, rotation


def test_orientations_go_the_shorter_way_round() -> None:
    turn = Rotation.from_rotvec([0.0, 0.0, 1.0])
    a = sn.Target((0, 0, 3), rotation=np.eye(3))
    b = sn.Target((0, 1, 3), rotation=turn)
    position, _, rotation = asked(TipLine(a, b).at(0.25))
    np.testing.assert_allclose(position, [0.0, 0.25, 3.0])
    np.testing.assert_allclose(rotation, Rotation.from_rotvec([0.0, 0.0, 0.25]).as_matrix(), atol=1e-12)
    a, b = sn.Target((0, 0, 3), direction=(1, 0, 0)), sn.Target((0, 0, 3), direction=(0, 1, 0))
    np.testing.assert_allclose(asked(TipLine(a, b).at(0.5))[1], [0.5**0.5, 0.5**0.5, 0.0], atol=1e-12)
    opposite = TipLine(a, sn.Target((0, 0, 3), direction=(-1, 0, 0)))
    assert asked(opposite.at(0.5))[1] @ [1.0, 0.0, 0.0] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(asked(opposite.at(1.0))[1], [-1.0, 0.0, 0.0], atol=1e-12)
    same = TipLine(a, sn.Target((0, 0, 2), direction=(1, 0, 0)))
    np.testing.assert_allclose(asked(same.at(0.3))[1], [1.0, 0.0, 0.0])


def test_there_is_one_where_the_same_is_asked_of_the_tip() -> None:
    place, turned = sn.Target((0, 0, 3)), sn.Target((0, 1, 3), direction=(0, 0, 1))
    elbow, direction = sn.Target((0, 0, 1), segment=1), sn.Target(direction=(0, 0, 1))
    assert TipLine.between((place,), (place,)) is not None
    assert TipLine.between((turned,), (turned,)) is not None
    pairs = [
        ((place,), (turned,)),
        ((elbow,), (elbow,)),
        ((direction,), (direction,)),
        ((place, elbow), (place, elbow)),
    ]
    assert all(TipLine.between(begin, end) is None for begin, end in pairs)
    assert TipLine.between(None, (place,)) is None
