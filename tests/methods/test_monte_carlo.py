"""Monte Carlo: draws are even, repeatable, within their range and the limits; and the whole method, which is slow."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.problem import Problem
from sinuous.methods import monte_carlo
from sinuous.methods.monte_carlo import MonteCarlo
from tests.helpers import Floats, refused
from tests.methods import laws

MIXED = sn.Robot(
    [
        sn.Segment((0.5, 2.0), 2.0),
        sn.Segment((0.5, 2.0), 3.0, max_curvature=1.5),
        sn.Segment((0.2, 1.0), 1.0),
        sn.Segment(1.0, 0.0),
        sn.Segment(0.7, np.pi),
    ]
)

LOOSE = sn.Tolerance(1.0, 0.01)


def drawn(count: int, seed: int) -> Floats:
    state = np.array([seed], np.uint64)
    return np.array([monte_carlo.draw(state) for _ in range(count)])


def test_numbers_are_even_and_repeat_for_a_seed() -> None:
    x = drawn(20_000, 5)
    assert (x >= -1.0).all()
    assert (x < 1.0).all()
    quantiles = np.linspace(0.05, 0.95, 19)
    np.testing.assert_allclose(np.quantile(x, quantiles), 2.0 * quantiles - 1.0, atol=0.03)
    assert abs(np.corrcoef(x[:-1], x[1:])[0, 1]) < 0.03
    np.testing.assert_array_equal(drawn(50, 5), x[:50])
    assert (drawn(50, 6) != x[:50]).all()


def scattered(robot: sn.Robot, q: Floats, share: float, count: int) -> Floats:
    values: dict[str, Any] = dict.fromkeys(Problem._fields, 0.0)
    problem = Problem(**{**values, "limits": robot.limits, "actuation": robot.actuation})
    n = len(robot)
    work = monte_carlo.Work(q.copy(), np.empty((n, 3)), np.empty((n, 3)), np.array([1], np.uint64))
    out = []
    for _ in range(count):
        monte_carlo.scatter(problem, work, share)
        out.append(work.trial.copy())
    return np.stack(out)


@pytest.mark.parametrize("share", [1.0, 0.1, 1e-6])
def test_draws_stay_in_their_range_and_within_the_limits(share: float) -> None:
    middle = np.array([[0.0, 0.0, 0.5 * sum(segment.length)] for segment in MIXED.segments])
    found = scattered(MIXED, middle, share, 300)
    assert MIXED.excess(found) <= 1e-12
    reach = share * np.array([2.0, 3.0, 1.0, 0.0, np.pi])
    assert (np.abs(found[..., :2]) <= reach[:, None] + 1e-12).all()
    spread = 0.5 * share * (MIXED.limits[:, 1] - MIXED.limits[:, 0])
    assert (np.abs(found[..., 2] - middle[:, 2]) <= spread + 1e-12).all()
    # And they fill it.
    assert (np.abs(found[..., 2] - middle[:, 2]).max(axis=0) >= 0.9 * spread).all()
    assert (np.abs(found[..., 0]).max(axis=0) >= 0.5 * reach).all()


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
