"""Peers begin where we do, and get what helps them."""

import numpy as np

from benchmarks.problems import arm, reachable, relative_tolerance
from benchmarks.solvers.peers import Ipopt, LeastSquares, start_of


def test_peers_solve_an_easy_problem_from_the_same_start() -> None:
    drawn = reachable(arm(3, 1.0), 3, np.random.default_rng(0))
    asked = drawn.with_tolerance(relative_tolerance(drawn.robot, 1e-6))
    assert start_of(asked.robot, asked.targets[0]).shape == (9,)
    for peer in (LeastSquares(asked), LeastSquares(asked, dogbox=True), Ipopt(asked), Ipopt(asked, equalities=True)):
        solved = 0
        for target in asked.targets:
            q, seconds = peer.solve(target)
            assert seconds > 0.0
            assert target.position is not None
            solved += bool(np.linalg.norm(asked.robot.tip(q)[:3, 3] - target.position) < 1e-3)
        assert solved >= 2


def test_the_jacobian_given_to_scipy_is_right() -> None:
    asked = reachable(arm(3, 1.0), 1, np.random.default_rng(0))
    peer, (target,) = LeastSquares(asked), asked.targets
    goal = np.array(target.position) + 100.0, np.array(target.direction)
    x = start_of(asked.robot, target) + 0.1
    numeric = np.empty((6, 9))
    for i in range(9):
        step = 1e-6 * np.eye(9)[i]
        numeric[:, i] = (peer._residual(x + step, *goal) - peer._residual(x - step, *goal)) / 2e-6
    np.testing.assert_allclose(peer._jacobian(x, *goal), numeric, atol=1e-7)
