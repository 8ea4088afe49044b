"""The straight line of the tip between waypoints."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.motion.knots import TipLine


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


@pytest.mark.parametrize("place", [(0.0, 0.0, 3.0), (0.0, 1.0, 3.0)])
def test_poses_on_the_line_are_where_they_are(place: tuple[float, ...]) -> None:
    """Also on a line that is a turn on the spot."""
    shares, turn = np.linspace(0.0, 1.0, 7), Rotation.from_rotvec([0.3, -0.2, 0.7]).as_matrix()
    along = Rotation.from_rotvec([0.5, 1.0, -0.4])
    for begin, end in (
        (sn.Target((0, 0, 3), rotation=turn), sn.Target(place, rotation=turn @ along.as_matrix())),
        (sn.Target((0, 0, 3), direction=turn[:, 2]), sn.Target(place, direction=along.apply(turn[:, 2]))),
    ):
        line, poses = TipLine(begin, end), np.tile(np.eye(4), (7, 1, 1))
        poses[:, :3, 3] = [asked(line.at(share))[0] for share in shares.tolist()]
        if begin.rotation is None:
            poses[:, :3, 2] = line.direction(shares)
        else:
            poses[:, :3, :3] = line.rotations(shares)
        np.testing.assert_allclose(line.shares_of(poses), shares, atol=1e-9)
        if begin.rotation is not None:
            assert line.angle == pytest.approx(along.magnitude())
