"""Bodies at rest as searches read them: how they move with the drive is what differences of equilibria say."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.statics.rest import Rest
from tests.helpers import with_each

STEP = 1e-6

ROD: dict[str, Any] = {"stiffness": sn.Stiffness(0.01, 0.008), "mass": 0.05, "gravity": (0.0, 1.0, -9.81)}
SOFT: dict[str, Any] = {
    **ROD,
    "stiffness": sn.Stiffness(0.01, 0.008, 4.0),
    "payload": sn.Payload(0.01, (0.01, 0, 0.02)),
}


def segment(**more: Any) -> sn.Segment:
    return sn.Segment(**{"length": (0.07, 0.13), "max_bend": 2.0, "radius": 0.005, **more})


def pulled(**more: Any) -> sn.Segment:
    return segment(tendons=sn.Tendons(3, 0.004, **more))


STIFF = segment(mass=0.05), segment(mass=0.05, stiffness=sn.Stiffness(0.01, 0.008))
ELASTIC = segment(length=0.1, tendons=sn.Tendons(3, 0.004, stiffness=400.0))

ROBOTS = {
    "inextensible": sn.Robot([segment()] * 3, arcs=4, payload=sn.Payload(0.01), **ROD),
    "extensible": sn.Robot([segment()] * 3, arcs=4, **SOFT),
    "rigid sections": sn.Robot([*STIFF, *STIFF], arcs=3, gravity=(0.0, 1.0, -9.81), payload=sn.Payload(0.01)),
    "tendons": sn.Robot([pulled()] * 3, arcs=4, **ROD),
    "straight tendons": sn.Robot([pulled(straight=True)] * 3, arcs=4, **ROD),
    "joints": sn.Robot([pulled()] * 2, arcs=3, joints=[sn.Revolute((0, 1, 0.3)), sn.Prismatic(limits=(0, 1))], **ROD),
    "elastic tendons": sn.Robot([ELASTIC] * 3, arcs=4, **{**ROD, "stiffness": sn.Stiffness(0.01)}),
}


@pytest.mark.parametrize("straight", [False, True])
def test_a_stage_that_is_drawn_back_all_the_way_has_a_derivative(straight: bool) -> None:
    robot = sn.on_stage(sn.Robot([pulled(straight=straight)] * 2, arcs=4, **ROD), 0.1)
    q = np.array([[0.0, 0.0, 0.0], [0.4, 0.1, 0.1], [-0.2, 0.3, 0.1]])
    ahead = q.copy()
    ahead[0, 2] = STEP
    rest = Rest(robot, q)
    apart = (Rest(robot, ahead, rest).found[0] - rest.found[0]) / STEP
    assert rest.slopes[2] == pytest.approx(apart, abs=1e-5)


@with_each("name", ROBOTS)
@with_each("size", [1.0, 1e-3])
def test_the_derivative_by_the_drive_is_that_of_differences(name: str, size: float) -> None:
    robot = ROBOTS[name]
    q = np.resize([[0.5, 0.2, 0.1], [-0.4, 0.6, 0.1], [0.3, 0.3, 0.1]], (len(robot.segments), 3)) * (size, size, 1.0)
    q = robot.with_joints(q, [0.4, 0.1][: len(robot.joint_names)])
    rest = Rest(robot, q)
    for i in np.flatnonzero(robot.drive.coordinates.unlocked):  # not the length of a joint that turns
        slope, step = rest.slopes[i], np.zeros(q.size)
        step[i] = STEP
        ahead, back = (Rest(robot, q + side * step.reshape(q.shape), rest).found[0] for side in (1.0, -1.0))
        assert slope == pytest.approx((ahead - back) / (2.0 * STEP), abs=1e-6 * (1.0 + np.abs(slope).max()))
