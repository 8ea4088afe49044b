"""Limits one by one agree with what the robot says of all of them."""

import numpy as np
import pytest

from sinuous import Actuators, Chambers, Robot, Segment, Tendons
from sinuous.model.limits import normal
from tests.helpers import Floats, with_each

ROBOT = Robot(
    [
        Segment((0.5, 1.0), 1.5, max_curvature=1.2, tendons=Tendons(3, 0.1, displacement=(-0.05, 0.1))),
        Segment(0.7, 2.0, chambers=Chambers(3, 0.1, length=(0.6, 0.8))),
        Segment((0.0, 0.4), 0.0),
        Segment((0.6, 0.9), 1.0, tendons=Tendons(4, 0.08, 0.3, displacement=(-0.06, 0.06))),
    ],
    actuators=Actuators(
        [[0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0, 0], [5, 0, 0, 5, 0, 0, 5, 0, 0, 5, 0, 0]], limits=[[-3, 2], [-4, 9]]
    ),
)


def random_q(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.normal(0.0, 0.8, (4, 2)), rng.uniform(0.1, 1.2, 4)])


@with_each("seed", range(30))
def test_the_least_slack_is_the_excess(seed: int) -> None:
    q = random_q(seed)
    assert -min(limit.slack for limit in ROBOT.limit_set.sides(q)) == pytest.approx(ROBOT.excess(q), abs=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_normals_are_derivatives_of_the_slack(seed: int) -> None:
    q, unit, h = random_q(seed), 0.7, 1e-6
    steps = h * np.eye(12).reshape(12, 4, 3) * [1.0, 1.0, unit]
    less, more = (
        np.array([[each.slack for each in ROBOT.limit_set.sides(one)] for one in q + s * steps]) for s in (-1, 1)
    )
    for limit, numbers in zip(ROBOT.limit_set.sides(q), ((less - more) / (2.0 * h)).T, strict=True):
        if limit.key == "max_bend" and limit.segment == 3:
            continue  # a bend that is none has no direction
        np.testing.assert_allclose(normal(limit, unit), numbers, atol=1e-8)
