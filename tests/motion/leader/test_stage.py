"""A robot on an insertion stage."""

import numpy as np
import pytest

import sinuous as sn

ARM = sn.Robot.uniform(
    2, (40, 60), radius=3, tendons=sn.Tendons(3, radius=2), base=sn.pose((1, 2, 3), direction=(0, 1, 1))
)


def test_drawn_back_its_tip_is_at_the_base_of_before() -> None:
    robot = sn.on_stage(ARM, 100)
    tip = robot.forward([[0, 0, 0], [0, 0, 60], [0, 0, 60]])[-1]
    np.testing.assert_allclose(tip, ARM.base, atol=1e-12)
    pushed = robot.forward([[0, 0, 100], [0, 0, 60], [0, 0, 60]])[-1]
    np.testing.assert_allclose(pushed[:3, 3], ARM.base[:3, 3] + 100 * ARM.base[:3, 2], atol=1e-12)
    assert robot.segment_names == ("stage", "s1", "s2")
    assert [actuator.name for actuator in robot.actuators] == [actuator.name for actuator in ARM.actuators]


def test_actuators_of_the_arm_stay_what_they_are() -> None:
    driven = sn.Robot.uniform(2, 50.0, actuators=sn.Actuators(np.eye(6)[[0, 4]], names=["a", "b"], limits=(-1, 1)))
    robot = sn.on_stage(driven, 100)
    q = np.array([[0.3, 0.2, 50], [0.1, -0.4, 50]])
    np.testing.assert_allclose(robot.to_actuators([[0, 0, 20], *q]), driven.to_actuators(q))


@pytest.mark.parametrize(
    ("travel", "name", "message"),
    [(0.0, "stage", "travel: expected a number greater than 0"), (1.0, "s1", "s1")],
)
def test_what_is_no_stage_is_refused(travel: float, name: str, message: str) -> None:
    with pytest.raises(sn.InputError, match=message):
        sn.on_stage(ARM, travel, name)
