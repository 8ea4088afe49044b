"""Damped least squares: the Jacobian, the damped system, the limits of a step, and the whole method."""

import pytest

import sinuous as sn
from sinuous.methods.dls import Dls
from tests.helpers import refused
from tests.methods import laws


@pytest.mark.parametrize("kind", ["position", "direction", "rotation"])
def test_reachable_targets(kind: str) -> None:
    solver = sn.Solver(laws.ARM, method="dls")
    assert laws.solved_and_verified(solver, laws.tip_targets(laws.ARM, 60, 2.0, kind=kind)) == 60


def test_a_step_goes_no_farther_than_its_clamp() -> None:
    """Far away and hardly moving: with a small clamp and few steps the tip stays near its start."""
    start = laws.shapes(laws.ARM, 1, 1.0, 0)[0]
    target = sn.Target((200, 0, 0))
    moved = []
    for clamp in (0.01, 0.1):
        solver = sn.Solver(laws.ARM, method=Dls(iterations=1, clamp=clamp, damping=0.0), max_starts=1)
        solution = solver.solve(target, initial=start)
        moved.append(abs(laws.ARM.tip(solution.q)[:3, 3] - laws.ARM.tip(start)[:3, 3]).max())
    assert 0.0 < moved[0] < 0.02 * laws.ARM.mean_length
    assert moved[1] > 5.0 * moved[0]


def test_what_it_cannot_mean_is_refused() -> None:
    refused("damping", lambda: Dls(damping=-1.0))
    refused("clamp", lambda: Dls(clamp=0.0))
    refused("iterations", lambda: Dls(iterations=0))
    solver = sn.Solver(laws.ARM, method="dls")
    refused("target.segment", lambda: solver.solve(sn.Target((0, 0, -100), segment=2)))
    refused("targets", lambda: solver.solve([sn.Target((0, 0, -200)), sn.Target(direction=(0, 0, 1))]))
