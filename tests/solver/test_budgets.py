"""What comes of a solve whose time is over, and of one that is interrupted: never a claim without proof."""

import os
import signal
import sys
import threading

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.arguments import MethodName
from sinuous.kernels.clock import SEGMENT_WORK, STRIDE
from sinuous.methods.method import METHODS, capabilities
from sinuous.scene.obstacles import Obstacle
from tests.methods.laws import quick

ROBOT = sn.Robot.uniform(5, (0.8, 1.2), 2.0, radius=0.05)
STRAIGHT = np.tile([0.0, 0.0, 1.0], (5, 1))
AHEAD = sn.Target((0.0, 0.0, 5.0), direction=(0, 0, 1))
GRAZED = sn.Box((0, 0, 0), (0.1 + 2e-7, 20, 20), inside=True)
"""Walls between which a proof takes millions of looks."""

FAR: list[Obstacle] = [sn.Sphere((9.0, 0.01 * i, 0.0), 0.5) for i in range(2 * STRIDE)]
"""More obstacles than looks between two times that the clock is read."""


@pytest.mark.parametrize("method", METHODS)
def test_every_method_ends_when_there_is_no_time(method: MethodName) -> None:
    """After so many looks, with what it has then; most of them are not even through with one start."""
    scenes: list[list[Obstacle]] = [[], FAR] if capabilities(method).obstacles else [[]]
    for scene in scenes:
        solver = sn.Solver(ROBOT, scene, method=quick(method, ROBOT), routes=False)
        found = solver.solve(sn.Target((1.0, 2.0, 2.0), direction=(0, 1, 0)), time=0.0)
        assert found.starts <= 1
        assert found.iterations * len(ROBOT) * SEGMENT_WORK <= 2 * STRIDE
        assert found.solved or found.status in (sn.Status.TIME_LIMIT, sn.Status.UNPROVED)
        assert np.isfinite(found.q).all()
        assert found.position_error is not None
        assert np.isfinite(found.position_error)
        assert found.solved == found.verify().ok or found.status is sn.Status.UNPROVED


def test_the_first_start_is_told_whatever_it_is() -> None:
    """Among many obstacles the time is over before the first linearisation: there is a configuration all the same."""
    found = sn.Solver(ROBOT, FAR).solve(AHEAD, initial=0.9 * STRAIGHT, time=0.0)
    assert found.status is sn.Status.TIME_LIMIT
    np.testing.assert_array_equal(found.q, 0.9 * STRAIGHT)
    assert found.position_error == pytest.approx(0.5)


@pytest.mark.parametrize("method", ["newton", "monte_carlo"])
def test_a_proof_that_takes_too_long_is_none(method: MethodName) -> None:
    solver = sn.Solver(ROBOT, [GRAZED], method=method, routes=False, max_starts=1)
    found = solver.solve(AHEAD, initial=STRAIGHT, time=1e-3)
    assert found.status is sn.Status.UNPROVED
    assert found.clearance is None
    np.testing.assert_array_equal(found.q, STRAIGHT)


@pytest.mark.skipif(sys.platform == "win32", reason="there a process cannot send itself this signal")
@pytest.mark.parametrize("count", [1, 4])
def test_an_interrupt_is_heard_within_a_call(count: int) -> None:
    solver = sn.Solver(ROBOT, [GRAZED], routes=False)
    solver.solve_many([AHEAD] * count, initial=[STRAIGHT] * count, time=0.0)  # machine code is loaded before
    threading.Timer(0.05, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        solver.solve_many([AHEAD] * count, initial=[STRAIGHT] * count, time=60.0)
