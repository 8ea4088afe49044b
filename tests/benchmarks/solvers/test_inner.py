"""The kernel in a loop."""

import numpy as np

from benchmarks.problems import paper_poses
from benchmarks.solvers.inner import inner_times
from sinuous.solver.solver import Solver


def test_the_compiled_loop_solves_the_same_problem() -> None:
    asked = paper_poses()
    run = inner_times(asked, 3)
    solver = Solver(asked.robot, tolerance=asked.tolerance)
    assert run.solved.all()
    assert (run.seconds > 0.0).all()
    np.testing.assert_array_equal(run.q, [solver.solve(target).q for target in asked.targets])
