"""FABRIKc, with segments that stretch and without, and FABRIKx: sections of several segments, whose links differ."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.methods.fabrik.reaching import Fabrikc, Fabrikx
from tests.helpers import refused
from tests.methods import laws

TAPERED = sn.Robot.uniform(8, (15, 20), 1.2)


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


def test_what_it_cannot_mean_is_refused() -> None:
    refused("iterations", lambda: Fabrikc(iterations=0))
    refused("stretch", lambda: Fabrikc(stretch="no"))  # type: ignore[arg-type]
    solver = sn.Solver(laws.ARM, method="fabrikc")
    refused("target.position", lambda: solver.solve(sn.Target(direction=(0, 0, 1))))
    refused("target.rotation", lambda: solver.solve(sn.Target((0, 0, -200), rotation=np.eye(3))))


def test_with_one_segment_a_section_it_is_fabrikc_of_fixed_lengths() -> None:
    one, other = (sn.Solver(laws.ARM, method=method) for method in (Fabrikx(), Fabrikc(stretch=False)))
    for target in laws.tip_targets(laws.ARM, 20):
        np.testing.assert_array_equal(one.solve(target).q, other.solve(target).q)


@pytest.mark.parametrize("taper", [0.0, 0.7, -0.7])
def test_sections_of_variable_curvature(taper: float) -> None:
    """Targets of robots that bend so; the answers do too."""
    rng = np.random.default_rng(1)
    share = (1.0 + taper * np.array([-0.5, 0.5])) / 2.0
    bend, angle = 1.2 * rng.random((40, 4)), 2.0 * np.pi * rng.random((40, 4))
    sections = np.stack([bend * np.cos(angle), bend * np.sin(angle)], axis=-1)
    solver = sn.Solver(TAPERED, method=Fabrikx(pieces=2, taper=taper))
    targets = []
    for bends in sections:
        q = np.empty((8, 3))
        q[:, :2] = (bends[:, None, :] * share[:, None]).reshape(8, 2)
        q[:, 2] = 17.5
        targets.append(sn.Target(TAPERED.tip(q)[:3, 3]))
    assert laws.solved_and_verified(solver, targets) >= 38
    for target in targets[:10]:
        found = solver.solve(target).q[:, :2].reshape(4, 2, 2)
        np.testing.assert_allclose(found[:, 0] * share[1], found[:, 1] * share[0], atol=1e-12)


def test_limits_and_starts_and_obstacles_of_fabrikx() -> None:
    laws.keeps_its_limits(Fabrikx(pieces=2), laws.LIMITED)
    laws.begins_from_an_initial_configuration("fabrikx")
    laws.does_not_pretend("fabrikx")
