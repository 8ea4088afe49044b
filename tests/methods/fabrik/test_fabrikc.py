"""FABRIKc as a method, with segments that stretch and without."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.methods.fabrik.fabrikc import Fabrikc
from tests.helpers import refused
from tests.methods import laws


def test_the_papers_poses_better_than_published() -> None:
    """Published for the first two: within a millimetre, and no error of direction."""
    solver = sn.Solver(laws.ARM, method="fabrikc", tolerance=sn.Tolerance(1e-3, 1e-6))
    assert laws.solved_and_verified(solver, laws.PAPER) == 4


@pytest.mark.parametrize("kind", ["position", "direction"])
@pytest.mark.parametrize("max_bend", [1.2, 2.4])
def test_reachable_targets(kind: str, max_bend: float) -> None:
    solver = sn.Solver(laws.ARM, method="fabrikc", max_starts=1)
    assert laws.solved_and_verified(solver, laws.tip_targets(laws.ARM, 100, max_bend, kind=kind)) >= 98


def test_fixed_lengths() -> None:
    robot = sn.Robot.uniform(5, 57.5)
    solver = sn.Solver(robot, method="fabrikc")
    assert laws.solved_and_verified(solver, laws.tip_targets(robot, 50)) >= 48
    still = sn.Solver(laws.ARM, method=Fabrikc(stretch=False), max_starts=1)
    start = laws.shapes(laws.ARM, 1, 1.0, 3)[0]
    solution = still.solve(sn.Target(laws.ARM.tip(start)[:3, 3] + [3, 4, 5]), initial=start)
    assert solution.solved
    np.testing.assert_allclose(solution.q[:, 2], start[:, 2], rtol=1e-14)
    assert np.abs(solution.q[:, :2] - start[:, :2]).max() > 1e-3


def test_tools() -> None:
    for tool in (sn.pose((0, 0, 20)), sn.pose((5, 0, 20)), sn.pose((3, 4, 20), direction=(0.3, 0, 1))):
        robot = sn.Robot(laws.ARM.segments, tool=tool)
        solver = sn.Solver(robot, method="fabrikc")
        assert laws.solved_and_verified(solver, laws.tip_targets(robot, 20)) == 20
        assert laws.solved_and_verified(solver, laws.tip_targets(robot, 20, kind="position")) == 20


def test_a_batch_is_a_loop() -> None:
    laws.many_are_as_one(sn.Solver(laws.ARM, method="fabrikc"), laws.tip_targets(laws.ARM, 20, 2.4))


def test_limits_and_starts_and_obstacles() -> None:
    laws.keeps_its_limits("fabrikc", laws.LIMITED)
    laws.begins_from_an_initial_configuration("fabrikc")
    laws.does_not_pretend("fabrikc")


def test_more_segments() -> None:
    robot = sn.Robot.uniform(40, (5, 7), 1.0)
    solver = sn.Solver(robot, method="fabrikc")
    assert laws.solved_and_verified(solver, laws.tip_targets(robot, 20, 0.5)) == 20


def test_what_it_cannot_mean_is_refused() -> None:
    refused("iterations", lambda: Fabrikc(iterations=0))
    refused("stretch", lambda: Fabrikc(stretch="no"))  # type: ignore[arg-type]
    solver = sn.Solver(laws.ARM, method="fabrikc")
    refused("target.position", lambda: solver.solve(sn.Target(direction=(0, 0, 1))))
    refused("target.rotation", lambda: solver.solve(sn.Target((0, 0, -200), rotation=np.eye(3))))
