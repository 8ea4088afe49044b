"""The worst constraint is what is missed by most, in comparable units; what it says can be written and read."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.answer.verification import verify
from sinuous.answer.worst import Worst, find_overlap, find_worst
from tests.cases import with_each
from tests.helpers import refused

ROBOT = sn.Robot.uniform(2, (0.8, 1.2), 1.0, radius=0.1)
UNITS = {"angle": 1.0, "bend": 1.0, "curvature": 1.0}
"""What counts in rad; all others are lengths, and count in mean lengths of the robot."""


@with_each("seed", range(12))
def test_nothing_is_missed_by_more(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q = np.column_stack([rng.normal(0.0, 0.6, (2, 2)), rng.uniform(0.7, 1.3, 2)])
    place = ROBOT.tip(q)[:3, 3] + rng.normal(0.0, 0.1, 3)
    problem = sn.Problem(ROBOT, sn.Target(place, direction=rng.normal(size=3)), [sn.Sphere(place, 0.2, name="ball")])
    worst, slow = find_worst(problem, q, False), verify(problem, q)
    unit = ROBOT.mean_length
    missed = [slow.position_error / unit, slow.angle_error, -slow.clearance / unit]
    missed += [amount / UNITS.get(name, unit) for name, _, amount in ROBOT.violations(q)]
    assert worst.amount / UNITS.get(worst.constraint, unit) == pytest.approx(max(missed), rel=1e-2)
    overlap = find_overlap(ROBOT, problem.scene, q)
    assert overlap.obstacle == "ball"
    assert overlap.amount == pytest.approx(-slow.clearance, abs=1e-3)


def test_it_is_read_as_it_was_written() -> None:
    worst = Worst("clearance", 2, "ball", 0.125)
    assert Worst.from_dict(worst.to_dict()) == worst
    refused("worst", lambda: Worst.from_dict({"constraint": "clearance"}))
