"""FABRIKx as a method: sections of several segments, whose links differ."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.methods.fabrik.fabrikc import Fabrikc
from sinuous.methods.fabrik.fabrikx import Fabrikx
from tests.helpers import refused
from tests.methods import laws

TAPERED = sn.Robot.uniform(8, (15, 20), 1.2)


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


def test_the_papers_first_two_poses() -> None:
    solver = sn.Solver(laws.ARM, method="fabrikx", tolerance=sn.Tolerance(1.0, 0.01))
    assert laws.solved_and_verified(solver, laws.PAPER[:2]) == 2


def test_a_batch_is_a_loop() -> None:
    laws.many_are_as_one(sn.Solver(TAPERED, method=Fabrikx(pieces=3)), laws.tip_targets(TAPERED, 20, 0.6))


def test_limits_and_starts_and_obstacles() -> None:
    laws.keeps_its_limits(Fabrikx(pieces=2), laws.LIMITED)
    laws.begins_from_an_initial_configuration("fabrikx")
    laws.does_not_pretend("fabrikx")


def test_what_it_cannot_mean_is_refused() -> None:
    refused("pieces", lambda: Fabrikx(pieces=0))
    refused("taper", lambda: Fabrikx(taper=1.0))
    refused("taper", lambda: Fabrikx(taper=-1.0))
