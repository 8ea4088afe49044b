"""What both trees find is proved while there is time, and no step is proved after one of which that was in vain."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.query import ANSWER_WIDTH, VERDICT
from sinuous.motion.planning.query import Deadline
from sinuous.motion.planning.rrt_connect import RRTConnect
from sinuous.solver.certificates.steps import LOOSE_SECONDS, Prover, unproved

ROBOT = sn.Robot.uniform(3, 1.0, 2.0, radius=0.1)
SCENE = sn.Scene([sn.Sphere((2.0, 0.0, 2.0), 0.3)])
KNOTS = np.linspace(0.0, 0.2, 6)[:, None, None] * np.ones((3, 3)) * (1.0, 1.0, 0.0) + (0.0, 0.0, 1.0)


def trees() -> RRTConnect:
    return RRTConnect(ROBOT, SCENE.snapshot())


def test_what_is_not_proved_is_proved_again() -> None:
    path = trees()._proved(KNOTS, unproved(5), Deadline(60.0))
    assert (path.answers[:, VERDICT] == CLEAR).all()


def test_nothing_is_proved_when_the_time_is_over() -> None:
    path = trees()._proved(KNOTS, unproved(5), Deadline(0.0))
    np.testing.assert_array_equal(path.answers, unproved(5))


def test_proofs_have_no_more_time_than_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[float] = []

    def in_vain(self: Prover, knots: Floats, slack: float, seconds: float) -> Floats:
        given.append(seconds)
        return unproved(len(knots) - 1)

    monkeypatch.setattr(Prover, "prove", in_vain)
    for seconds in (0.01, 60.0):
        path = trees()._proved(KNOTS, unproved(5), Deadline(seconds))
        assert path.answers.shape == (5, ANSWER_WIDTH)
    assert 0.0 < given[0] <= 0.01
    assert given[1:] == [LOOSE_SECONDS]
