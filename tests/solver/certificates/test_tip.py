"""How far the tip leaves a straight line."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.solver.certificates.tip import Tip

ROBOT = sn.Robot.uniform(4, (0.7, 1.3), max_bend=3.0)
TOOL = np.array([[1.0, 0.0, 0.0, 0.9], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.5], [0.0, 0.0, 0.0, 1.0]])
TOOLED = ROBOT.changed(tool=TOOL)


def random_configuration(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    q: Floats = np.concatenate([rng.uniform(-2.0, 2.0, (4, 2)), rng.uniform(0.7, 1.3, (4, 1))], axis=-1)
    return q


def deviation(robot: sn.Robot, ends: Floats, line: Floats, enough: float = 0.0) -> float:
    tip = Tip(robot)
    tip.line[:] = line
    return tip.deviation(ends, enough)


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
    for enough in (0.0, 0.01, 10.0):
        assert measured <= deviation(robot, ends, tips[[0, -1]], enough) + 1e-9


def test_the_bound_of_the_deviation_is_tight_for_small_steps() -> None:
    """At eight places it is looked at; what is between them is of second order."""
    q0 = random_configuration(3)
    q1 = q0 + 0.01 * (random_configuration(4) - q0)
    a, b = (ROBOT.tip(q)[:3, 3] for q in (q0, q1))
    middle = ROBOT.tip(0.5 * (q0 + q1))[:3, 3] - 0.5 * (a + b)
    assert deviation(ROBOT, np.stack([q0, q1]), np.stack([a, b])) < 3.0 * float(np.linalg.norm(middle))


def test_a_line_that_the_tip_does_not_follow_is_left() -> None:
    q = random_configuration(1)
    here = ROBOT.tip(q)[:3, 3]
    ends = np.stack([q, q + 1e-9])
    assert deviation(ROBOT, ends, np.stack([here, here])) == pytest.approx(0.0, abs=1e-7)
    assert deviation(ROBOT, ends, np.stack([here, here]) + [[1.0], [3.0]] * np.eye(3)[0]) == pytest.approx(1.0)
