"""Limits of actuators of the whole robot, as solvers keep them."""

from typing import Any

import numpy as np
import pytest

from sinuous.kernels import tables as t
from sinuous.problem.target import Target
from sinuous.robot.actuators import Actuators
from sinuous.robot.robot import Robot
from sinuous.robot.segment import Segment
from sinuous.solving.solver import Solver
from tests.helpers import refused

PARTS = [
    Segment((0.0, 0.5), max_bend=0.0),
    Segment(1.0, 2.0),
    Segment(0.1, max_bend=0.0),
    Segment((0.8, 1.2), 2.0),
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


@pytest.mark.parametrize("name", ROWS)
@pytest.mark.parametrize("gain", [1.0, 1e6, 1e-4])
def test_a_row_says_the_same_within_the_limits_of_segments(name: str, gain: float) -> None:
    """It is as far from both limits as the value itself, times one factor."""
    limits = -50.0 * gain, 40.0 * gain
    robot = Robot(PARTS, actuators=Actuators([np.multiply(ROWS[name], gain)], limits=limits))
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
    [
        row(NONE, PLANE, NONE, (0.3, 0.2, 0)),
        row(NONE, PLANE, NONE, (0.6, -0.4, 0)),
        row((0, 0, 1), NONE, NONE, PLANE),
    ],
)
def test_limits_that_no_row_says_are_refused(weights: list[float]) -> None:
    key = "actuators.limits[0]"
    refused(key, lambda: Robot(PARTS, actuators=Actuators([weights], limits=(-9, 9))), "equal from the first up to one")
    assert len(Robot(PARTS, actuators=Actuators([weights])).actuation) == 0


def test_limits_that_straight_robots_violate_are_refused() -> None:
    stage = [row((0, 0, 2), *[NONE] * 3)]
    assert len(Robot(PARTS, actuators=Actuators(stage, limits=(0.0, 1.0))).actuation) == 0
    refused("actuators.limits[0]", lambda: Robot(PARTS, actuators=Actuators(stage, limits=(0.0, 0.9))), "[0, 1]")
    bent = [ROWS["one segment"]]
    refused("actuators.limits[0]", lambda: Robot(PARTS, actuators=Actuators(bent, limits=(0.1, 0.9))), "[0, 0]")


def test_rows_are_in_the_order_of_their_last_segment() -> None:
    own = [ROWS["a sum"], ROWS["one segment"], ROWS["the last one"]]
    robot = Robot(PARTS, actuators=Actuators(own, limits=(-3, 3)))
    assert robot.actuation[:, t.LAST_SEGMENT].tolist() == [1, 3, 3]


@pytest.mark.parametrize("name", ["one segment", "a sum", "tendon lengths"])
def test_solvers_keep_them(name: str) -> None:
    free = Robot(PARTS)
    rng = np.random.default_rng(1)
    bound = 0
    for _ in range(20):
        q = np.array([(0, 0, 0.2), (*rng.normal(size=2) * 0.6, 1), (0, 0, 0.1), (*rng.normal(size=2) * 0.6, 1)])
        tip = free.tip(q)
        narrow = Actuators([ROWS[name]], limits=(1.8, 2.9) if name == "tendon lengths" else (-0.15, 0.15))
        robot = Robot(PARTS, actuators=narrow)
        solution = Solver(robot, time=0.05, max_starts=20).solve(Target(tip[:3, 3]))
        assert robot.excess(solution.q) <= 1e-9
        freely = Solver(free).solve(Target(tip[:3, 3]))
        bound += robot.excess(freely.q) > 1e-3
    assert bound > 3
