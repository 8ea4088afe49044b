"""The straight way of the tip between waypoints."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.checks import Floats
from sinuous.motion.following.straight import Straight, Tip

ROBOT = sn.Robot.uniform(4, (0.7, 1.3), max_bend=3.0)
TOOL = np.array([[1.0, 0.0, 0.0, 0.9], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.5], [0.0, 0.0, 0.0, 1.0]])
TOOLED = ROBOT.changed(tool=TOOL)


def random_configuration(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    q: Floats = np.concatenate([rng.uniform(-2.0, 2.0, (4, 2)), rng.uniform(0.7, 1.3, (4, 1))], axis=-1)
    return q


@pytest.mark.parametrize("robot", [ROBOT, TOOLED], ids=["arm", "tool"])
@given(st.integers(0, 10_000), st.floats(1e-4, 0.3))
def test_the_bound_of_the_deviation_holds(robot: sn.Robot, seed: int, share: float) -> None:
    q0 = random_configuration(seed)
    q1 = q0 + share * (random_configuration(seed + 1) - q0)
    ends = np.stack([q0, q1])
    t = np.linspace(0.0, 1.0, 101)[:, None, None]
    tips = robot.tip((1.0 - t) * q0 + t * q1)[:, :3, 3]
    line = tips[-1] - tips[0]
    along = np.clip((tips - tips[0]) @ line / (line @ line), 0.0, 1.0)
    measured = np.linalg.norm(tips - tips[0] - along[:, None] * line, axis=-1).max()
    way = Straight(sn.Target(tips[0]), sn.Target(tips[-1]))
    for enough in (0.0, 0.01, 10.0):
        assert measured <= Tip(robot).deviation(ends, way, (0.0, 1.0), enough) + 1e-9


def test_the_bound_of_the_deviation_is_tight_for_small_steps() -> None:
    """At eight places it is looked at; what is between them is of second order."""
    q0 = random_configuration(3)
    q1 = q0 + 0.01 * (random_configuration(4) - q0)
    a, b = (ROBOT.tip(q)[:3, 3] for q in (q0, q1))
    middle = ROBOT.tip(0.5 * (q0 + q1))[:3, 3] - 0.5 * (a + b)
    way = Straight(sn.Target(a), sn.Target(b))
    assert Tip(ROBOT).deviation(np.stack([q0, q1]), way, (0.0, 1.0), 0.0) < 3.0 * float(np.linalg.norm(middle))


def test_a_part_of_the_line_is_between_its_shares() -> None:
    q = random_configuration(1)
    here = ROBOT.tip(q)[:3, 3]
    way = Straight(sn.Target(np.subtract(here, [1, 0, 0])), sn.Target(np.add(here, [3, 0, 0])))
    ends = np.stack([q, q + 1e-9])
    assert Tip(ROBOT).deviation(ends, way, (0.25, 0.25), 0.0) == pytest.approx(0.0, abs=1e-7)
    assert Tip(ROBOT).deviation(ends, way, (0.5, 1.0), 0.0) == pytest.approx(1.0)


def test_no_motion_has_no_deviation() -> None:
    q = random_configuration(0)
    here = sn.Target(ROBOT.tip(q)[:3, 3])
    found = Tip(ROBOT).deviation(np.stack([q, q]), Straight(here, here), (0.0, 1.0), 0.0)
    assert found == pytest.approx(0.0, abs=1e-12)


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
