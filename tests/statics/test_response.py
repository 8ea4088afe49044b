"""Derivatives of shapes under load: against differences of shapes that are found anew, and laws of statics."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.statics import lines
from sinuous.kernels.statics.profile import end_profile, even_functions
from sinuous.statics.equilibrium import Equilibrium, find_equilibrium
from sinuous.statics.response import GROUPS
from tests.helpers import Floats, refused

ROD = sn.Stiffness(bend=1.0, twist=0.7, stretch=40.0)
LOADS = sn.Force((0.4, -0.6, 0.3), (0.1, 0.2, -0.1), position=(0.05, 0.0, 0.1)), sn.Payload(0.1, (0.0, 0.02, 0.0), 1)
TENDONS = sn.Tendons(3, 0.03, stiffness=500.0)


def arm(tendons: sn.Tendons | None = None) -> sn.Robot:
    segments = [sn.Segment((0.3, 0.6), radius=0.01, tendons=tendons)] * 2
    carried = sn.Payload(0.05, (0.0, 0.01, 0.02))
    return sn.Robot(segments, stiffness=ROD, mass=0.3, arcs=4, gravity=(0.3, 0.0, -2.0), payload=carried)


def bent(angle: float) -> Equilibrium:
    return arm().shape([[angle, 0.3 * angle, 0.5], [-0.2 * angle, 0.9 * angle, 0.4]], LOADS)


EQUILIBRIA = {
    "straight": lambda: bent(1e-4),
    "bent": lambda: bent(0.6),
    "pi": lambda: bent(3.0),
    "actuators": lambda: arm(TENDONS).equilibrium(
        arm(TENDONS).to_actuators([[0.4, 0.2, 0.5], [-0.3, 0.5, 0.4]]), LOADS, initial=[[0.0, 0.0, 0.5]] * 2
    ),
    "tensions": lambda: arm(TENDONS).equilibrium(None, LOADS, tensions=[3.0, 6.0, 2.0, 4.0, 1.0, 2.0]),
}


def differences(found: Equilibrium, name: Any, i: int) -> Floats:
    """Differences of states that are found from the shape without load, with two steps."""
    column = list(GROUPS[name](found.question))[i]
    steps = 1e-3, -1e-3, 5e-4, -5e-4
    ends = [find_equilibrium(column.changed(h * column.scale)).states for h in steps]
    wide, narrow = (ends[0] - ends[1]) / 2e-3, (ends[2] - ends[3]) / 1e-3
    change: Floats = (4.0 * narrow - wide) / 3.0 / column.scale
    return change


@pytest.mark.parametrize("kind", list(EQUILIBRIA))
def test_derivatives_agree_with_differences(kind: str) -> None:
    found = EQUILIBRIA[kind]()
    groups: list[Any] = ["loads", "payload", "gravity", "stiffness", "base", found.question.drive]
    derivative = found.derivative(groups)
    assert derivative.regular
    for name in groups:
        for i in range(len(derivative.labels(name))):
            wanted = differences(found, name, i)
            scale = np.abs(derivative.states[name]).max()
            np.testing.assert_allclose(derivative.states[name][..., i], wanted, atol=1e-6 * scale, err_msg=name)


@pytest.mark.parametrize("kind", ["straight", "along"])
def test_slopes_of_lines_and_their_slopes_agree_with_differences(kind: str) -> None:
    """The length of a tendon by bends, twist and length of its arc."""

    def line(x: Floats) -> tuple[float, Floats, Floats]:
        own = (end_profile(even_functions(x[0] ** 2 + x[1] ** 2)),) if kind == "straight" else ()
        length, slope, curved = getattr(lines, kind)(*x, 0.04, -0.07, *own)
        return length, np.array(slope), np.array(curved)

    x, h = np.array([0.6, -0.9, 0.4, 1.3]), 1e-6
    ends = [(line(x + step), line(x - step)) for step in h * np.eye(4)]
    np.testing.assert_allclose(line(x)[1], [(a[0] - b[0]) / (2.0 * h) for a, b in ends], atol=1e-8)
    second = np.array([(a[1] - b[1]) / (2.0 * h) for a, b in ends])
    np.testing.assert_allclose(line(x)[2], second[np.triu_indices(4)], atol=1e-8)


def test_a_cantilever_bends_as_in_books() -> None:
    rod = sn.Robot([sn.Segment(2.0)], stiffness=sn.Stiffness(bend=3.0), arcs=24)
    derivative = rod.shape([[0.0, 0.0, 2.0]], sn.Force()).derivative()
    assert derivative.labels("loads")[0] == "loads[0].force_x"
    assert derivative.tip["loads"][3, 0] == pytest.approx(2.0**3 / (3.0 * 3.0), rel=2e-3)
    assert derivative.tip["loads"][1, 4] == pytest.approx(2.0 / 3.0, rel=1e-6)


def test_the_base_carries_everything_where_nothing_pulls() -> None:
    robot = sn.Robot([sn.Segment(0.5)] * 2, stiffness=ROD)
    derivative = robot.shape([[0.5, 0.2, 0.5], [-0.4, 0.9, 0.5]]).derivative("base")
    np.testing.assert_allclose(derivative.states["base"], 0.0, atol=1e-9)
    np.testing.assert_allclose(derivative.tip["base"][:3, :3], np.eye(3), atol=1e-7)
    np.testing.assert_allclose(derivative.tip["base"][3:, 3:], np.eye(3), atol=1e-9)


def test_where_a_tendon_just_becomes_slack_there_is_a_kink() -> None:
    robot = sn.Robot([sn.Segment(1.0, tendons=sn.Tendons(3, 0.1))], stiffness=sn.Stiffness(bend=1.0), arcs=2)
    slack = robot.equilibrium([0.0, 0.0, 0.0])
    assert not slack.derivative("actuators").regular
    assert slack.derivative("stiffness").regular


def test_bad_input_is_refused() -> None:
    found = bent(0.6)
    refused("wrt", lambda: found.derivative("tensions"), "loads, payload, gravity")
    refused("wrt", lambda: found.derivative(()), "names nothing")
    refused("wrt", lambda: found.derivative().labels("q"), "was not asked for")
    refused("wrt", lambda: found.derivative().jvp({"q": [1.0]}), "was not asked for")
    refused("cotangent", lambda: found.derivative().vjp([[1.0]]))
