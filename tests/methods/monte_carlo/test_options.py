"""Monte Carlo as a method: slow, but it can mean anything."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.methods.monte_carlo.options import MonteCarlo
from tests.helpers import refused
from tests.methods import laws

LOOSE = sn.Tolerance(1.0, 0.01)


def test_the_papers_first_two_poses() -> None:
    solver = sn.Solver(laws.ARM, method="monte_carlo", tolerance=LOOSE, time=10.0)
    assert laws.solved_and_verified(solver, laws.PAPER[:2]) == 2


@pytest.mark.parametrize("kind", ["position", "direction", "rotation"])
def test_reachable_targets(kind: str) -> None:
    solver = sn.Solver(laws.ARM, method="monte_carlo", tolerance=LOOSE, time=10.0)
    assert laws.solved_and_verified(solver, laws.tip_targets(laws.ARM, 8, kind=kind)) == 8


def test_elbows_and_obstacles_and_tendons() -> None:
    robot = sn.Robot.uniform(
        3, (0.8, 1.2), 2.0, radius=0.05, tendons=sn.Tendons(count=3, radius=0.1, displacement=(-0.3, 0.3))
    )
    scene = sn.Scene([sn.Sphere((0.4, 0, 1.5), 0.3), sn.Box((0, -1, 1), (3, 0.5, 1))])
    solver = sn.Solver(robot, scene, method="monte_carlo", tolerance=sn.Tolerance(0.02, 0.05), time=10.0)
    tip, elbow = sn.Target((0.6, 0.3, 2.6)), sn.Target((-0.05, 0.2, 0.9), segment=1)
    assert laws.solved_and_verified(solver, [tip, elbow, [tip, elbow]]) == 3


def test_the_same_seed_gives_the_same_answer() -> None:
    targets = laws.tip_targets(laws.ARM, 3)
    solver = sn.Solver(laws.ARM, method="monte_carlo", tolerance=LOOSE, time=10.0)
    laws.many_are_as_one(solver, targets)
    other = sn.Solver(laws.ARM, method="monte_carlo", tolerance=LOOSE, time=10.0, seed=1)
    same = sn.Solver(laws.ARM, method="monte_carlo", tolerance=LOOSE, time=10.0)
    assert not np.array_equal(other.solve(targets[0]).q, same.solve(targets[0]).q)


def test_limits_and_starts_and_obstacles() -> None:
    laws.keeps_its_limits(MonteCarlo(rounds=5), laws.LIMITED)
    laws.begins_from_an_initial_configuration("monte_carlo")
    laws.does_not_pretend(MonteCarlo(rounds=50))


def test_what_it_cannot_mean_is_refused() -> None:
    refused("samples", lambda: MonteCarlo(samples=0))
    refused("shrink", lambda: MonteCarlo(shrink=0.0))
    refused("shrink", lambda: MonteCarlo(shrink=1.5))
