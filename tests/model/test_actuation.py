"""The values of tendons, chambers and other actuators, their names, and what bounds them."""

import math
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels import tables as t
from sinuous.model.actuation import Actuator
from tests.helpers import Floats, refused, refused_each, with_each

MIXED = sn.Robot(
    [
        sn.Segment((0.0, 0.5), max_bend=0.0, name="stage"),
        sn.Segment(1.0, tendons=sn.Tendons(3, 0.05, displacement=(-0.2, 0.3))),
        sn.Segment(0.1, max_bend=0.0),
        sn.Segment((0.8, 1.2), tendons=sn.Tendons(2, 0.04, 0.3), chambers=sn.Chambers(4, 0.1, 0.2, length=(0.7, 1.3))),
        sn.Segment(1.0, tendons=sn.Tendons(angles=[0.1, 2.0], radius=0.03, names=["left", "right"]), name="wrist"),
    ],
    actuators=sn.Actuators(
        [[0, 0, 1] + [0] * 12, [0, 0, 0, 2, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0]],
        names=["motor", "differential"],
        limits=[(0.0, 1.0), None],
    ),
    name="arm",
)
NAMES = [*(f"s2.t{i}" for i in (1, 2, 3)), "s4.t1", "s4.t2", *(f"s4.c{i}" for i in (1, 2, 3, 4))]
NAMES += ["left", "right", "motor", "differential"]


def one_by_one(robot: sn.Robot, q: Floats) -> list[float]:
    """Values of all actuators of a configuration (n, 3), by the formulas of a single one."""
    values = []
    for k, segment in enumerate(robot.segments):
        for lines in (segment.tendons, segment.chambers):
            for angle in [] if lines is None else lines.angles:
                toward = math.cos(angle), math.sin(angle)
                seen = [np.dot(row[:2], toward) for row in (q[: k + 1] if lines is segment.tendons else q[k : k + 1])]
                pulled = 0.0 if lines is None else lines.radius * sum(seen)
                values.append(pulled if lines is segment.tendons else q[k, 2] - pulled)
    return [*values, *([] if robot.linear is None else robot.linear.matrix @ q.ravel())]


def test_who_the_actuators_are() -> None:
    assert [each.name for each in MIXED.actuators] == NAMES
    assert MIXED.segment_names == ("stage", "s2", "s3", "s4", "wrist")
    assert MIXED.actuators[0] == Actuator("s2.t1", "tendon", 2, (-0.2, 0.3))
    assert MIXED.actuators[5] == Actuator("s4.c1", "chamber", 4, (0.7, 1.3))
    assert MIXED.actuators[11:] == (
        Actuator("motor", "linear", 1, (0.0, 1.0)),
        Actuator("differential", "linear", 4, (-math.inf, math.inf)),
    )
    assert sn.Robot.uniform(3, 1.0).actuators == ()
    assert sn.Robot.uniform(3, 1.0).to_actuators(np.zeros((5, 3, 3))).shape == (5, 0)
    assert repr(MIXED) == "Robot('arm', 5 segments, total length 2.9 to 3.8, 13 actuators)"
    assert repr(MIXED.segments[0]) == "Segment('stage', length=(0, 0.5), max_bend=0, radius=0)"


@pytest.mark.parametrize("lead", [(), (4,), (2, 3)])
def test_values_are_those_of_single_actuators(lead: tuple[int, ...]) -> None:
    q = np.random.default_rng(0).normal(size=(*lead, 5, 3))
    expected = np.array([one_by_one(MIXED, each) for each in q.reshape(-1, 5, 3)]).reshape(*lead, 13)
    np.testing.assert_allclose(MIXED.to_actuators(q), expected, atol=1e-14)
    one = q.reshape(-1, 5, 3)[-1]
    np.testing.assert_allclose(MIXED.to_actuators(one), one_by_one(MIXED, one), atol=1e-14)
    jacobian = MIXED.actuator_jacobian(q)
    assert jacobian.shape == (*lead, 13, 15)
    assert not jacobian.flags.writeable
    np.testing.assert_allclose(jacobian @ q.reshape(*lead, 15, 1), expected[..., None], atol=1e-14)


def test_a_value_beyond_its_limits_is_a_violation() -> None:
    straight = np.array([(0.0, 0.0, 0.1), (0, 0, 1), (0, 0, 0.1), (0, 0, 1), (0, 0, 1)])
    assert MIXED.violations(straight) == []
    bent = straight + np.array([(0, 0, 0), (0, 0, 0), (0, 0, 0), (3.1, 0, 0), (0, 0, 0)])
    found = [(kind, segment) for kind, segment, _ in MIXED.violations(bent)]
    assert found == [("actuator", 4)] * 2
    assert MIXED.excess(bent) == pytest.approx(0.7 - (1.0 - 0.1 * 3.1 * math.cos(0.2)))
    far = straight + np.array([(0, 0, 1.4), (0, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0)])
    assert [(kind, segment) for kind, segment, _ in MIXED.violations(far)] == [("length", 1), ("actuator", 1)]


def test_names_that_stand_twice_are_refused() -> None:
    two = [sn.Segment(1.0, name="a"), sn.Segment(1.0)]
    refused("segments[2].name", lambda: sn.Robot([*two, sn.Segment(1.0, name="a")]), "segments[0].name")
    refused("segments[1].name", lambda: sn.Robot([sn.Segment(1.0, name="s2"), sn.Segment(1.0)]), "own")
    pair = sn.Segment(1.0, tendons=sn.Tendons(2, 0.1, names=["x", "y"]))
    refused("segments[1].tendons.names[0]", lambda: sn.Robot([pair, pair]), "segments[0].tendons.names[0]")
    row = [[1.0, 0.0, 0.0]]
    refused("actuators.names[0]", lambda: sn.Robot([pair], actuators=sn.Actuators(row, names=["y"])))
    refused_each("name", ("", 3, ["a"]), lambda name: sn.Segment(1.0, name=name), "a text")
    refused_each("name", ("", 3, ["a"]), lambda name: sn.Robot(two, name=name), "a text")


def test_actuators_of_the_whole_robot_are_checked() -> None:
    refused_each("matrix", (None, 3, [1.0], [[math.nan]], "rows"), sn.Actuators, "numbers")
    refused("len(matrix)", lambda: sn.Actuators(np.zeros((0, 3))))
    refused("matrix[1]", lambda: sn.Actuators([[1, 0, 0], [0, 0, 0]]), "not zero")
    two = np.eye(3)[:2]
    assert sn.Actuators(two).names == ("a1", "a2")
    assert sn.Actuators(two, limits=(-1, 2)).limits == ((-1.0, 2.0), (-1.0, 2.0))
    assert sn.Actuators(two, limits=[None, (0, 1)]).limits == ((-math.inf, math.inf), (0.0, 1.0))
    refused_each("limits", (3, [(0, 1)], [(0, 1)] * 3, "wide"), lambda limits: sn.Actuators(two, limits=limits), "low")
    refused("limits[1]", lambda: sn.Actuators(two, limits=[None, (2, 1)]))
    refused("limits", lambda: sn.Actuators(two, limits=(2, 1)))
    refused("names", lambda: sn.Actuators(two, names=["a"]), "2 names")
    refused(
        "actuators.matrix",
        lambda: sn.Robot([sn.Segment(1.0)] * 2, actuators=sn.Actuators(two)),
        "(2, 6), for 2 segments",
    )
    bad: Any = [[1, 0, 0]]
    refused("actuators", lambda: sn.Robot([sn.Segment(1.0)], actuators=bad))


PARTS = [
    sn.Segment((0.0, 0.5), max_bend=0.0),
    sn.Segment(1.0, 2.0),
    sn.Segment(0.1, max_bend=0.0),
    sn.Segment((0.8, 1.2), 2.0),
]


def row(*weights: Any) -> list[float]:
    return [float(w) for segment in weights for w in segment]


NONE, PLANE = (0, 0, 0), (0.3, -0.2, 0)
ROWS = {
    "one segment": row(NONE, PLANE, NONE, NONE),
    "the last one": row(NONE, NONE, NONE, (0.1, 0.2, 1)),
    "a sum": row(NONE, PLANE, NONE, PLANE),
    "a sum over what cannot move, too": row(PLANE, PLANE, (9, 9, 7), PLANE),
    "tendon lengths": row(*[(0.9, -0.6, 1)] * 4),
    "lengths of fixed segments weigh what they like": row((5, 5, 2), (0.3, -0.2, -4), (1, 2, 3), (0.3, -0.2, 2)),
}


@with_each("name", ROWS)
@with_each("gain", [1.0, 1e6, 1e-4])
def test_a_row_says_the_same_within_the_limits_of_segments(name: str, gain: float) -> None:
    """It is as far from both limits as the value itself, times one factor."""
    limits = -50.0 * gain, 40.0 * gain
    robot = sn.Robot(PARTS, actuators=sn.Actuators([np.multiply(ROWS[name], gain)], limits=limits))
    (found,) = robot.actuation
    first, last = int(found[t.FIRST_SEGMENT]), int(found[t.LAST_SEGMENT])
    assert first in (0, last)
    rng = np.random.default_rng(0)
    q = rng.normal(size=(20, 4, 3)) * [[[0, 0, 0], [1, 1, 0], [0, 0, 0], [1, 1, 0]]]
    low, high = np.array([segment.length for segment in PARTS]).T
    q[..., 2] = rng.uniform(low, high, (20, 4))
    seen = q[:, first : last + 1].sum(axis=1) @ found[t.WEIGHTS : t.WEIGHTS + 3]
    values = robot.to_actuators(q)[:, 0]
    factor = (found[t.MAX_VALUE] - found[t.MIN_VALUE]) / (90.0 * gain)
    np.testing.assert_allclose(found[t.MAX_VALUE] - seen, factor * (limits[1] - values), rtol=1e-10)
    np.testing.assert_allclose(seen - found[t.MIN_VALUE], factor * (values - limits[0]), rtol=1e-10)


@pytest.mark.parametrize(
    "weights",
    [row(NONE, PLANE, NONE, (0.3, 0.2, 0)), row(NONE, PLANE, NONE, (0.6, -0.4, 0)), row((0, 0, 1), NONE, NONE, PLANE)],
)
def test_limits_that_no_row_says_are_refused(weights: list[float]) -> None:
    key = "actuators.limits[0]"
    bends = [row(*part) for part in np.eye(12).reshape(12, 4, 3)]  # with these all bends are driven
    limits = [(-9, 9), *[None] * len(bends)]
    driven = sn.Actuators([weights, *bends], limits=limits)
    refused(key, lambda: sn.Robot(PARTS, actuators=driven), "equal from the first up to one")
    assert len(sn.Robot(PARTS, actuators=sn.Actuators([weights, *bends])).actuation) == 0


@pytest.mark.parametrize("name", ["one segment", "a sum", "tendon lengths"])
def test_solvers_keep_them(name: str) -> None:
    free = sn.Robot(PARTS)
    rng = np.random.default_rng(1)
    bound = 0
    for _ in range(20):
        q = np.array([(0, 0, 0.2), (*rng.normal(size=2) * 0.6, 1), (0, 0, 0.1), (*rng.normal(size=2) * 0.6, 1)])
        tip = free.tip(q)
        narrow = sn.Actuators([ROWS[name]], limits=(1.8, 2.9) if name == "tendon lengths" else (-0.15, 0.15))
        robot = sn.Robot(PARTS, actuators=narrow)
        solution = sn.Solver(robot, time=0.05, max_starts=20).solve(sn.Target(tip[:3, 3]))
        assert robot.excess(solution.q) <= 1e-9
        freely = sn.Solver(free).solve(sn.Target(tip[:3, 3]))
        bound += robot.excess(freely.q) > 1e-3
    assert bound > 3
