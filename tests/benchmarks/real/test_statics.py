"""The figures of shapes under load are those of the data."""

import numpy as np
import pytest

from benchmarks.real import statics


def test_all_loads_of_the_tendon_robot_are_read() -> None:
    cases = statics.cases()
    assert len(cases) == 77
    assert all(np.isfinite(case.tips["VCref"]).all() for case in cases)


@pytest.mark.parametrize("name", statics.ROD_MATERIALS)
def test_rods_are_near_those_of_a_cosserat_solver(name: str) -> None:
    reached = {line.what: line.reached for line in statics.rods(name, 6)}
    assert all(value < 0.5 for value in reached.values())
    assert len(statics.read_rods(name)) == 400
