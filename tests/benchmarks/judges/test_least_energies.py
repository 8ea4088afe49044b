"""The judge of tensions agrees with what the package finds, and sees what is pulled by more than it may be."""

import numpy as np
import pytest

from benchmarks.motion.limits import KINDS, arm, drawn, is_false, most_pulled


@pytest.mark.parametrize("kind", KINDS)
def test_least_energies_have_the_tensions_of_equilibria(kind: str) -> None:
    rng = np.random.default_rng(1)
    robot = arm(kind, rng)
    q = drawn(robot, rng)
    found = most_pulled(robot, robot.to_actuators(q), q[:, 2], q)
    own = robot.shape(q).tensions if robot.has_external_load else robot.tensions(robot.to_actuators(q), q)
    assert found == pytest.approx(np.nanmax(own), rel=1e-3)
    lines = robot.segments[0].tendons
    assert lines is not None
    for share, false in ((1.01, False), (0.98, True)):
        held = lines.changed(tension=(0.0, share * found))
        assert (
            is_false(robot.changed(segments=[each.changed(tendons=held) for each in robot.segments]), q[None]) == false
        )
